// Bent normals and single suns of measure_points() under an open sky, and beside a wall that hides
// half of it, against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "dapple/points.hpp"
#include "support/scene_on_device.hpp"

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

/// A small square far below.
Scene open_sky() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(0.1f, -1000, 1, 0));
  return scene;
}

/// A wall that hides, from the origin, directions with x above 0, but for a part of 0.0001.
Scene sky_beside_wall() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh wall;
  append_grid(wall, {0.1f, -1, -1000}, {0, 1001, 0}, {0, 0, 2000}, 8, 0);
  place(scene, std::move(wall));
  return scene;
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
                  {V3f(0, 1, 0), 100},
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
      EXPECT_NEAR(value_of(all, "sun"), expected[0] + expected[1] + expected[2] + expected[3],
                  1e-3);
    };
    expect_suns(V3f(0, 1, 0), {800 * kSine, 0, 100, 0});
    expect_suns(V3f(-1, 0, 0), {800 * kCosine, 0, 0, 0});
  }
}

}  // namespace
}  // namespace dapple
