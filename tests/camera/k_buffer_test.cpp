// The k-buffer (Bavoil 2007) and stochastic transparency (Enderton 2010): a ray stops at the
// surface where the product of transmittances falls to the ray's threshold, for any number of
// surfaces in front. Each surface stops a share of a pixel's samples that equals its opacity.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "support/scenes/scene_on_device.hpp"

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

/// The threshold that closest_hit.cl gives the ray, in [0,1).
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

/// Rays down through sheets(), not on the quads' diagonals.
std::vector<Ray> rays_down(std::uint32_t count) {
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    rays.push_back(make_ray({0.3f, 1, 0.1f}, {0, -1, 0}));
    rays.back().key = i;
  }
  return rays;
}

TEST(KBufferOnDevice, StackedSheetsStopTheShareOfRaysThatTheirOpacitySays) {
  constexpr std::uint32_t kRays = 40'000;
  // The second and third stack have more sheets than the k-buffer has entries.
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

/// Triangles of various sizes in a cube, with opacities from `min_opacity` to nine times that.
std::vector<Triangle> triangle_soup(std::size_t count, float min_opacity) {
  Points random(11);
  std::vector<Triangle> soup;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = 0.05f + random.unit() * 0.6f;
    soup.push_back({random.in_cube(1), random.on_sphere() * size, random.on_sphere() * size,
                    min_opacity * static_cast<float>(1 + i % 9)});
  }
  return soup;
}

/// In thin_soup() rays pass more surfaces than the k-buffer has entries.
std::vector<Triangle> dense_soup() { return triangle_soup(1500, 0.1f); }
std::vector<Triangle> thin_soup() { return triangle_soup(5000, 0.006f); }

Scene scene_of(const std::vector<Triangle>& soup) {
  Scene scene;
  Mesh mesh;
  for (std::size_t i = 0; i < soup.size(); ++i) {
    const Triangle& t = soup[i];
    if (i < 9) scene.materials.push_back(material_of(t.opacity));
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {t.vertex, t.vertex + t.edge1, t.vertex + t.edge2});
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
    mesh.materials.push_back(static_cast<std::uint32_t>(i % 9));
  }
  place(scene, std::move(mesh));
  return scene;
}

/// Distance and transmittance of each triangle that the ray crosses, sorted by distance.
std::vector<std::pair<double, double>> crossed_by(const Ray& ray,
                                                  const std::vector<Triangle>& soup) {
  const V3d origin(ray.origin[0], ray.origin[1], ray.origin[2]);
  const V3d direction(ray.direction[0], ray.direction[1], ray.direction[2]);
  std::vector<std::pair<double, double>> crossings;
  for (const Triangle& triangle : soup) {
    const V3d e1(triangle.edge1), e2(triangle.edge2), s = origin - V3d(triangle.vertex);
    const V3d p = direction.cross(e2), q = s.cross(e1);
    const double inverse = 1 / e1.dot(p);
    const double u = s.dot(p) * inverse, v = direction.dot(q) * inverse, t = e2.dot(q) * inverse;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) crossings.emplace_back(t, 1.0 - triangle.opacity);
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

TEST(KBufferOnDevice, RaysStopAtTheSurfaceThatSortingFinds) {
  std::size_t deepest = 0;
  for (const std::vector<Triangle>& soup : {dense_soup(), thin_soup()}) {
    const SceneOnDevice scene(scene_of(soup));
    const std::vector<Ray> rays = rays_through(scene.bvh.bounds, 2000, 4, 0, 5);
    const std::vector<SurfacePoint> hits = closest_hits(device(), scene.uploaded, rays);
    std::size_t differ = 0, missed = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto crossings = crossed_by(rays[i], soup);
      double through = 1;
      std::size_t at = 0;
      while (at < crossings.size() && (through *= crossings[at].second) > threshold_of(rays[i]))
        ++at;
      deepest = std::max(deepest, at);
      missed += at == crossings.size();
      differ += at == crossings.size() ? hits[i].t >= 0
                                       : std::fabs(hits[i].t - crossings[at].first) > 1e-4;
    }
    EXPECT_GT(missed, 50u);
    // Rays that single precision puts on the other side of an edge.
    EXPECT_LE(differ, 4u);
  }
  EXPECT_GT(deepest, 50u) << "more than twice as many as there are layers";
}

RenderResult seen_from_above(Scene scene, int spp, std::optional<PixelRect> crop = {}) {
  RenderOptions options;
  options.width = 64;
  options.height = 48;
  options.spp = spp;
  options.light = false;
  options.ao_rays = 1;
  options.look = LookAt{{0, 10, 0}, {0, 0, 0}, {0, 0, -1}};
  options.fov_degrees = 5;
  options.crop = crop;
  return render(std::move(scene), options);
}

TEST(KBufferOnDevice, CoverageOfSheetsEqualsTheirOpacityWithinAStratum) {
  for (const auto& [count, opacity] : {std::pair(1, 0.5f), {1, 0.3f}, {3, 0.2f}, {24, 0.04f}}) {
    const RenderResult result = seen_from_above(sheets(count, opacity), 16);
    const double covered = 1 - std::pow(1 - opacity, count);
    double sum = 0;
    for (const float a : result.film.find("A")->pixels) {
      // With an independent random decision a surface, the standard deviation would be 1/8 at
      // opacity 0.5.
      EXPECT_NEAR(a, covered, 1.0 / 16 + 1e-5) << count << " of " << opacity;
      sum += a;
    }
    EXPECT_NEAR(sum / (64 * 48), covered, 4 * 0.5 / 16 / std::sqrt(64 * 48.0));
  }
}

TEST(KBufferOnDevice, CoverageAndDepthAgreeWithSorting) {
  constexpr int kSide = 100;
  const float half = std::tan(2.5f * static_cast<float>(kPi) / 180);
  for (const std::vector<Triangle>& soup : {dense_soup(), thin_soup()}) {
    const RenderResult result = seen_from_above(scene_of(soup), 64);
    // The truth for the same picture: rays through a grid of 100x100 points.
    double covered = 0, depth = 0;
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const float x = (2 * (static_cast<float>(i) + 0.5f) / kSide - 1) * half * 64 / 48;
        const float y = (2 * (static_cast<float>(j) + 0.5f) / kSide - 1) * half;
        const Ray ray = make_ray({0, 10, 0}, {x, -1, y});
        double through = 1;
        for (const auto& [t, kept] : crossed_by(ray, soup)) {
          covered += through * (1 - kept);
          depth -= through * (1 - kept) * t * ray.direction[1];
          through *= kept;
        }
      }
    }
    const std::vector<float>&a = result.film.find("A")->pixels, &z = result.film.find("Z")->pixels;
    double found = 0, found_depth = 0;
    for (std::size_t p = 0; p < a.size(); ++p) {
      found += a[p];
      if (a[p] > 0) found_depth += static_cast<double>(a[p]) * z[p];
    }
    // The error of 64 stratified samples a pixel and of 100x100 rays.
    EXPECT_NEAR(found / static_cast<double>(a.size()), covered / (kSide * kSide), 0.002);
    EXPECT_NEAR(found_depth / found, depth / covered, 0.002);
  }
}

TEST(KBufferOnDevice, ACropEqualsThatPartOfThePicture) {
  // In a crop other samples share a packet, and surfaces are found in another order.
  const RenderResult all = seen_from_above(scene_of(thin_soup()), 5);
  const RenderResult part = seen_from_above(scene_of(thin_soup()), 5, PixelRect{7, 5, 40, 30});
  for (const char* name : {"A", "Z", "P.X", "N.Y", "ao.R"}) {
    const Plane &whole = *all.film.find(name), &cut = *part.film.find(name);
    std::size_t differ = 0;
    for (int y = 5; y <= 30; ++y)
      for (int x = 7; x <= 40; ++x)
        differ += whole.pixels[static_cast<std::size_t>(y) * 64 + x] !=
                  cut.pixels[static_cast<std::size_t>(y - 5) * 34 + (x - 7)];
    EXPECT_EQ(differ, 0u) << name;
  }
}

}  // namespace
}  // namespace dapple
