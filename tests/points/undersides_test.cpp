// The sky above points on both sides of surfaces: rays start off a point along its normal, so that
// the underside of a leaf does not see through it.
#include <gtest/gtest.h>

#include <cmath>

#include "dapple/points.hpp"
#include "points/point_sources.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

constexpr float kFar = 3;  // of the leaf from the origin along X, Y and Z, metres

/// An opaque square leaf of 0.2 m whose front faces up, turned by `degrees` about X.
Scene tilted_leaf(double degrees) {
  const auto angle = static_cast<float>(degrees * kPi / 180);
  Mesh mesh;
  append_grid(mesh, {-0.1f, 0, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, 2, 0);
  Scene scene;
  scene.materials.push_back(material_of(1));
  M44f to_world;
  to_world.rotate(V3f(angle, 0, 0));
  to_world[3][0] = to_world[3][1] = to_world[3][2] = kFar;
  place(scene, std::move(mesh), to_world);
  return scene;
}

/// Means over the points of one side, of 8 triangles.
double mean_of_side(const PointList& list, const PointResult& result, const std::string& name,
                    bool up) {
  double sum = 0;
  for (const PointColumn& column : result.columns)
    for (std::size_t i = 0; column.name == name && i < list.points.size(); ++i)
      if ((list.normals[i].y > 0) == up) sum += column.values[i] / 8.0;
  return sum;
}

// Of a plane that is tilted by an angle a, (1 + cos a) / 2 of the cosine-weighted sky is above.
// 256 stratified rays at 8 points have an error of some 0.003.
TEST(Undersides, OfATiltedLeafSeeWhatIsBelowItOfTheSky) {
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered})
    for (const double degrees : {30.0, 60.0}) {
      const Scene scene = tilted_leaf(degrees);
      const PointList list = triangle_points(scene);
      PointOptions options;
      options.estimator = estimator;
      const PointResult result = measure_points(scene, list.points, list.normals, options);
      const double above = (1 + std::cos(degrees * kPi / 180)) / 2;
      EXPECT_NEAR(mean_of_side(list, result, "sky_view_factor", true), above, 0.01) << degrees;
      EXPECT_NEAR(mean_of_side(list, result, "sky_view_factor", false), 1 - above, 0.01) << degrees;
    }
}

TEST(Undersides, OfALevelLeafHaveNoGap) {
  const Scene scene = tilted_leaf(0);
  const PointList list = triangle_points(scene);
  PointOptions options;
  options.rings = 3;
  const PointResult result = measure_points(scene, list.points, list.normals, options);
  for (const std::string name : {"gap_1", "gap_2", "gap_3"}) {
    EXPECT_EQ(mean_of_side(list, result, name, true), 1) << name;
    EXPECT_EQ(mean_of_side(list, result, name, false), 0) << name;
  }
}

}  // namespace
}  // namespace dapple
