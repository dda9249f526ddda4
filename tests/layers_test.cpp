// Which surface stops a ray that slips through others: the one at which what has been let through
// falls to the ray's threshold, however many are in front of it, and of a pixel's samples the share
// that opacities say.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

std::uint32_t hash_of(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ x >> 16;
}

/// The threshold that closest_hit.cl gives a ray.
float threshold_of(const Ray& ray) {
  std::uint32_t bits = ray.key;
  for (int axis = 0; axis < 3; ++axis)
    for (const float of_ray : {ray.origin[axis], ray.direction[axis]})
      bits = hash_of(std::bit_cast<std::uint32_t>(of_ray) * 0x9e3779b1u + hash_of(bits));
  return static_cast<float>(bits >> 8) * (1.0f / 16777216.0f);
}

Scene sheets(int count, float opacity) {
  Scene scene;
  scene.materials.push_back(material_of(opacity));
  Mesh mesh;
  for (int sheet = 0; sheet < count; ++sheet)
    append_grid(mesh, {-1, -0.1f * static_cast<float>(sheet), -1}, {2, 0, 0}, {0, 0, 2}, 1, 0);
  place(scene, std::move(mesh));
  return scene;
}

/// Down through sheets(), off the diagonals.
std::vector<Ray> rays_down(std::uint32_t count) {
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    rays.push_back(make_ray({0.3f, 1, 0.1f}, {0, -1, 0}));
    rays.back().key = i;
  }
  return rays;
}

TEST(Layers, StackedSheetsStopTheShareOfRaysThatTheirOpacitySays) {
  constexpr std::uint32_t kRays = 40'000;
  // The second and third hold more sheets than there are layers.
  for (const auto& [count, opacity] : {std::pair(6, 0.3f), {40, 0.05f}, {30, 0.02f}, {3, 1.0f}}) {
    const SceneOnDevice scene(sheets(count, opacity));
    std::vector<double> stopped(static_cast<std::size_t>(count) + 1);
    for (const SurfacePoint& hit : closest_hits(device(), scene.uploaded, rays_down(kRays)))
      ++stopped[hit.t < 0 ? count : std::lround((hit.t - 1) * 10)];
    double left = 1;
    for (int sheet = 0; sheet <= count; ++sheet) {
      const double share = sheet < count ? left * opacity : left;
      const double deviation = std::sqrt(kRays * share * (1 - share));
      EXPECT_NEAR(stopped[sheet], kRays * share, 4.5 * deviation + 1e-6)
          << sheet << " of " << count << ", opacity " << opacity;
      left *= 1 - opacity;
    }
  }
}

struct Triangle {
  V3f vertex, edge1, edge2;
  float opacity;
};

/// Of all sizes and opacities, in a cube.
std::vector<Triangle> triangle_soup(std::size_t count) {
  Points random(11);
  std::vector<Triangle> soup;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = 0.05f + random.unit() * 0.6f;
    soup.push_back({random.in_cube(1), random.on_sphere() * size, random.on_sphere() * size,
                    0.1f * static_cast<float>(1 + i % 9)});
  }
  return soup;
}

Scene scene_of(const std::vector<Triangle>& soup) {
  Scene scene;
  for (int tenth = 1; tenth <= 9; ++tenth)
    scene.materials.push_back(material_of(0.1f * static_cast<float>(tenth)));
  Mesh mesh;
  for (const Triangle& t : soup) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {t.vertex, t.vertex + t.edge1, t.vertex + t.edge2});
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
    mesh.materials.push_back(static_cast<std::uint32_t>(std::lround(t.opacity * 10) - 1));
  }
  place(scene, std::move(mesh));
  return scene;
}

/// What stops a ray, one triangle after the other, sorted; negative: nothing. `crossed`: how many
/// it slips through first.
double brute_force(const std::vector<Triangle>& soup, const Ray& ray, std::size_t& crossed) {
  const V3d origin(ray.origin[0], ray.origin[1], ray.origin[2]);
  const V3d direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  std::vector<std::pair<double, double>> met;
  for (const Triangle& triangle : soup) {
    const V3d e1(triangle.edge1), e2(triangle.edge2), s = origin - V3d(triangle.vertex);
    const V3d p = direction.cross(e2), q = s.cross(e1);
    const double inverse = 1 / e1.dot(p);
    const double u = s.dot(p) * inverse, v = direction.dot(q) * inverse, t = e2.dot(q) * inverse;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) met.emplace_back(t, 1.0 - triangle.opacity);
  }
  std::sort(met.begin(), met.end());
  double through = 1;
  for (crossed = 0; crossed < met.size(); ++crossed)
    if ((through *= met[crossed].second) <= threshold_of(ray)) return met[crossed].first;
  return -1;
}

TEST(Layers, WhatStopsARayIsWhatSortingAllItsSurfacesSays) {
  const std::vector<Triangle> soup = triangle_soup(1500);
  const SceneOnDevice scene(scene_of(soup));
  const std::vector<Ray> rays = rays_through(scene.bvh.bounds, 4000, 4, 0, 5);
  const std::vector<SurfacePoint> hits = closest_hits(device(), scene.uploaded, rays);
  std::size_t differ = 0, deepest = 0, missed = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::size_t crossed = 0;
    const double t = brute_force(soup, rays[i], crossed);
    deepest = std::max(deepest, crossed);
    missed += t < 0;
    differ += t < 0 ? hits[i].t >= 0 : std::fabs(hits[i].t - t) > 1e-4;
  }
  EXPECT_GT(deepest, 8u);
  EXPECT_GT(missed, 100u);
  // Edges that single precision puts on the ray's other side.
  EXPECT_LE(differ, 4u);
}

RenderResult seen_from_above(Scene scene, int spp) {
  RenderOptions options;
  options.width = 64;
  options.height = 48;
  options.spp = spp;
  options.light = false;
  options.ao_rays = 1;
  options.look = LookAt{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}};
  options.fov_degrees = 5;
  return render(std::move(scene), options);
}

TEST(Layers, EveryPixelOfSheetsIsCoveredAsOpacitySaysToAStratum) {
  for (const auto& [count, opacity] : {std::pair(1, 0.5f), {1, 0.3f}, {3, 0.2f}, {24, 0.04f}}) {
    const RenderResult result = seen_from_above(sheets(count, opacity), 16);
    const double covered = 1 - std::pow(1 - opacity, count);
    double sum = 0;
    for (const float a : result.film.find("A")->pixels) {
      // Thresholds decided by one coin a surface would be off by 1/8.
      EXPECT_NEAR(a, covered, 1.0 / 16 + 1e-5) << count << " of " << opacity;
      sum += a;
    }
    EXPECT_NEAR(sum / (64 * 48), covered, 4 * 0.5 / 16 / std::sqrt(64 * 48.0));
  }
}

TEST(Layers, APictureCoversWhatExactRaysSay) {
  const std::vector<Triangle> soup = triangle_soup(1500);
  constexpr int kSide = 200;
  const RenderResult result = seen_from_above(scene_of(soup), 64);
  // The same 64x48 pixels' cone, one ray through each of 200x200 places.
  const SceneOnDevice scene(scene_of(soup));
  const float half = std::tan(2.5f * static_cast<float>(kPi) / 180);
  std::vector<Ray> rays;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const float x = (2 * (static_cast<float>(i) + 0.5f) / kSide - 1) * half * 64 / 48;
      const float y = (2 * (static_cast<float>(j) + 0.5f) / kSide - 1) * half;
      rays.push_back(make_ray({0, 10, 0}, {x, -1, y}));
    }
  }
  const double expected = 1 - mean_transmittance(scene.trace(rays, Estimator::exact));
  const std::vector<float>& a = result.film.find("A")->pixels;
  const double found = std::accumulate(a.begin(), a.end(), 0.0) / static_cast<double>(a.size());
  EXPECT_NEAR(found, expected, 0.002);
  EXPECT_GT(expected, 0.5);
  EXPECT_LT(expected, 0.999);
}

}  // namespace
}  // namespace dapple
