// Bent normals and single suns of measure_points() under an open sky, and beside a wall that hides
// half of it, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Of the first point.
float value_of(const PointResult& result, const std::string& name) {
  for (const PointColumn& column : result.columns)
    if (column.name == name) return column.values.at(0);
  ADD_FAILURE() << "no column " << name;
  return 0;
}

PointResult measured_at_origin(const Scene& scene, const V3f& normal, const PointOptions& options) {
  return measure_points(scene, std::vector{V3f(0, 0, 0)}, std::vector{normal}, options);
}

/// Independent rays would err by 0.004 at one sigma.
constexpr int kRays = 65536;
constexpr double kNoise = 0.015;

V3f bent_at_origin(const Scene& scene, const V3f& normal, Estimator estimator) {
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.bent = true;
  options.estimator = estimator;
  options.rays = kRays;
  const PointResult found = measured_at_origin(scene, normal, options);
  return {value_of(found, "bent_x"), value_of(found, "bent_y"), value_of(found, "bent_z")};
}

Scene scene_of(Mesh mesh, float opacity) {
  Scene scene;
  scene.materials.push_back(material_of(opacity));
  place(scene, std::move(mesh));
  return scene;
}

/// A small square far below.
Scene open_sky() { return scene_of(square_mesh(0.1f, -1000, 1, 0), 1); }

/// A wall that hides, from the origin, directions with x above 0, but for a part of 0.0001.
Scene sky_beside_wall() {
  Mesh wall;
  append_grid(wall, {0.1f, -1, -1000}, {0, 1001, 0}, {0, 0, 2000}, 8, 0);
  return scene_of(std::move(wall), 1);
}

TEST(BentNormals, UnderAnOpenSkyTheyAreTheNormals) {
  const Scene scene = open_sky();
  for (const V3f& normal : {V3f(0, 1, 0), V3f(1, 0, 0), V3f(-2, 1, 2) / 3.0f})
    EXPECT_LT((bent_at_origin(scene, normal, Estimator::exact) - normal).length(), kNoise)
        << normal;
}

// Directions w are weighted by their cosine. Over the quarter of the sphere with x below 0 and y
// above it, the integrals of w cos are -2/3, pi/3 and 0.
TEST(BentNormals, BesideAWallThatHidesHalfTheSkyTheyLeanAway) {
  const V3f expected = V3f(-2, static_cast<float>(kPi), 0).normalized();
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    const V3f found = bent_at_origin(sky_beside_wall(), V3f(0, 1, 0), estimator);
    EXPECT_LT((found - expected).length(), kNoise) << found;
    EXPECT_NEAR(found.length(), 1, 1e-5);
  }
}

TEST(Suns, EachHasItsIrradianceTimesItsCosineUnlessAWallHidesIt) {
  constexpr float kSine = 0.5f, kCosine = 0.8660254f;  // 30 degrees above the horizon
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.suns = {{V3f(-kCosine, kSine, 0), 800},
                  {V3f(kCosine, kSine, 0), 700},  // behind the wall
                  {V3f(-0.6f, 0.8f, 0), 100},
                  {V3f(0, -1, 0), 50}};
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    options.estimator = estimator;
    const auto expect_suns = [&](const V3f& normal, const std::array<float, 4>& expected) {
      options.per_sun = true;
      const PointResult each = measured_at_origin(sky_beside_wall(), normal, options);
      EXPECT_EQ(each.columns.size(), expected.size());
      for (std::size_t s = 0; s < expected.size(); ++s)
        EXPECT_NEAR(value_of(each, "sun_" + std::to_string(s)), expected[s], 1e-3) << s;
      options.per_sun = false;
      const PointResult all = measured_at_origin(sky_beside_wall(), normal, options);
      // Its rays may divide the suns a little unevenly.
      const float sum = expected[0] + expected[1] + expected[2] + expected[3];
      EXPECT_NEAR(value_of(all, "sun"), sum, 1e-3 * sum);
    };
    expect_suns(V3f(0, 1, 0), {800 * kSine, 0, 80, 0});
    expect_suns(V3f(-1, 0, 0), {800 * kCosine, 0, 60, 0});
  }
}

/// A roof ten metres above the ground over all points with x < 0.
Scene roof() {
  Mesh mesh;
  append_grid(mesh, {-100, 10, -100}, {100, 0, 0}, {0, 0, 200}, 1, 0);
  return scene_of(std::move(mesh), 1);
}

PointResult of_zenith_sun(const Scene& scene, const std::vector<V3f>& points) {
  PointOptions options;
  options.ao = options.sky_view_factor = false;
  options.estimator = Estimator::exact;
  options.suns = {{V3f(0, 1, 0), 1}};
  return measure_points(scene, points, std::vector<V3f>(points.size(), V3f(0, 1, 0)), options);
}

// At the distance d from the shadow's middle line, in radii of the sun's disk, the roof hides a
// segment of the disk: of area acos(d) - d sqrt(1 - d^2), over pi.
TEST(Suns, HavePenumbrasAsWideAsTheirDisks) {
  const double radius = 10 * std::tan(0.533 / 2 * kPi / 180);
  for (const double d : {-1.1, -0.6, 0.0, 0.3, 0.8, 1.1}) {
    const double inside = std::clamp(d, -1.0, 1.0);
    const double hidden = (std::acos(inside) - inside * std::sqrt(1 - inside * inside)) / kPi;
    const PointResult found = of_zenith_sun(roof(), {V3f(static_cast<float>(d * radius), 0, 0.3f)});
    EXPECT_NEAR(value_of(found, "sun"), 1 - hidden, 0.02) << d;
    if (std::fabs(d) > 1) {
      EXPECT_EQ(value_of(found, "sun_error"), 0);
    }
  }
}

// A ray to the middle of the sun would go through an edge or a corner that triangles share.
TEST(Suns, BelowTheEdgesOfTranslucentTrianglesOneOfThemCounts) {
  Mesh net;
  append_grid(net, {-2, 2, -2}, {4, 0, 0}, {0, 0, 4}, 8, 0);
  for (const V3f& point : {V3f(0, 0, 0), V3f(0.5f, 0, 0.25f), V3f(0.25f, 0, 0.25f)}) {
    const PointResult found = of_zenith_sun(scene_of(net, 0.3f), {point});
    EXPECT_NEAR(value_of(found, "sun"), 0.7, 0.003) << point;
  }
}

}  // namespace
}  // namespace dapple
