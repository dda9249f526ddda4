// Scenes that repeat: where the copies are, that they do not emit, how many points need, and which
// points are measured elsewhere.
#include "points/periodic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// A square from x 0.25 to 0.75, 1 m high.
Scene post() {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh mesh;
  append_grid(mesh, {0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}, 1, 0);
  M44f at;
  at.setTranslation(V3f(0.25f, 0, 0));
  place(scene, std::move(mesh), at);
  return scene;
}

// Lights are of the scene, not of what surrounds it: a lamp that every copy repeats would be
// brighter.
TEST(Periodic, CopiesLieOnTheGridAndDoNotEmit) {
  Scene scene = post();
  scene.instances[0].light = 0;
  scene.lights.emplace_back().kind = LightKind::mesh;
  repeat(scene, 8, 16, {});
  // 11.43 m reach: two copies and one more to each side along x, one and one more along z.
  EXPECT_EQ(scene.instances.size(), 7u * 5u);
  EXPECT_EQ(std::count_if(scene.instances.begin(), scene.instances.end(),
                          [](const Instance& i) { return i.light >= 0; }),
            1);
  for (const Instance& instance : scene.instances) {
    const V3f moved = instance.to_world.translation();
    EXPECT_EQ(std::remainder(moved.x - 0.25f, 8.0f), 0.0f);
    EXPECT_EQ(std::remainder(moved.z, 16.0f), 0.0f);
    EXPECT_EQ(moved.y, 0.0f);
  }
}

std::size_t copies_for(const std::vector<V3f>& points) {
  Scene scene = post();
  repeat(scene, 8, 16, points);
  return scene.instances.size();
}

// The reach is 11.43 times the height; then half of a period to the point, and half to the side.
TEST(Periodic, CopiesReachAsFarAsPointsNeed) {
  EXPECT_EQ(copies_for({V3f(0, 0, 0), V3f(1, 1, 1)}), 7u * 5u);
  for (const V3f& point : {V3f(0, -2, 0), V3f(0, 3, 0)})  // 34.29 m
    EXPECT_EQ(copies_for({point}), 13u * 9u);
  EXPECT_EQ(copies_for({V3f(-19.5f, 0, 0)}), 11u * 5u);  // 20 m from the middle, and 11.43 m
}

TEST(Periodic, CopiesOfAWideSceneReachAsFarAsItsSides) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  place(scene, square_mesh(32, 1, 1, 0));
  repeat(scene, 8, 16, std::vector{V3f(0, 0, 0)});
  EXPECT_EQ(scene.instances.size(), 13u * 7u);  // 16 m to either side, and 11.43 m
}

TEST(Periodic, TooManyCopiesAreAnErrorThatSaysWhatTakesThem) {
  Scene scene = post();
  const V3f deep(0, -500, 0);
  try {
    repeat(scene, 1, 2, std::vector{deep});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(
        std::string(error.what()).find("scene and points are 501 m high (the scene from y = "),
        std::string::npos)
        << error.what();
  }
}

TEST(Periodic, PointsBeyondThePeriodAreMovedIntoIt) {
  const std::vector<V3f> points{{4.25f, 5, -8}, {5, 5, 8.5f}, {-20.5f, 5, 0.5f}};
  const std::vector<V3f> moved = points_in_period(post(), 8, 16, points);  // the middle is 0.5, 0
  EXPECT_EQ(moved[0], points[0]);
  EXPECT_EQ(moved[1], V3f(-3, 5, -7.5f));
  EXPECT_EQ(moved[2], V3f(3.5f, 5, 0.5f));
}

// Copies do not emit: a point below another copy is as far from a lamp as it is, if lamps count.
TEST(Periodic, PointsKeepTheirPlaceIfALightThatIsMeasuredHasOne) {
  Scene scene = post();
  Light lamp;
  lamp.kind = LightKind::sphere;
  lamp.position = V3f(0, 5, 0);
  scene.lights = {lamp};
  EXPECT_TRUE(has_placed_light(scene));
  scene.lights[0].name = "lamp";
  const std::vector<V3f> below{V3f(0.5f, 0, 0.3f)}, beside{V3f(80.5f, 0, 0.3f)};
  const std::vector<V3f> up{V3f(0, 1, 0)};
  PointOptions options;
  options.period_x = 8;
  options.period_z = 16;
  options.estimator = Estimator::exact;
  const auto measured = [&](const std::vector<V3f>& points, const std::string& name) {
    for (const PointColumn& column : measure_points(scene, points, up, options).columns)
      if (column.name == name) return column.values.at(0);
    return -1.0f;
  };
  EXPECT_LT(measured(beside, "lamp_r"), 0.1f * measured(below, "lamp_r"));
  options.lights = false;
  EXPECT_EQ(measured(beside, "ao"), measured(below, "ao"));
  EXPECT_GT(measured(below, "ao"), 0.1f);
}

}  // namespace
}  // namespace dapple
