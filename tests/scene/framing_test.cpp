// The default camera of a scene that has none: the scene fills its frame. Also look_at(), and the
// views that it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A scene of one triangle. Its bounds have this minimum corner and this size.
Scene triangle_at(V3f corner, V3f size) {
  Scene scene;
  scene.materials.resize(1);
  Mesh mesh;
  mesh.positions = {corner, corner + size, corner + V3f(0, 0, size.z)};
  mesh.indices = {0, 1, 2};
  mesh.materials = {0};
  scene.meshes.push_back(mesh);
  scene.instances.emplace_back();
  return scene;
}

// The part of the frame that the points take, from -1 to 1 in both directions of the picture.
Imath::Box2f extent_in_frame(const Camera& camera, float aspect, const std::vector<V3f>& points) {
  const M44f to_camera = camera.to_world.inverse();
  const float tan_y = std::tan(camera.fov_y / 2);
  Imath::Box2f extent;
  for (const V3f& point : points) {
    const V3f p = point * to_camera;
    EXPECT_LT(p.z, 0) << "behind the camera";
    extent.extendBy(Imath::V2f(-p.x / p.z / (tan_y * aspect), -p.y / p.z / tan_y));
  }
  return extent;
}

// The longer side of the scene in the picture takes 1 / 1.1 of the frame, and both are in its
// middle.
void expect_framed(const Camera& camera, float aspect, const std::vector<V3f>& points,
                   float tolerance = 1e-4f) {
  const Imath::Box2f extent = extent_in_frame(camera, aspect, points);
  const Imath::V2f half = extent.size() / 2;
  const int side = half.x > half.y ? 0 : 1;
  EXPECT_NEAR(half[side], 1 / 1.1f, tolerance);
  EXPECT_NEAR(extent.center()[side], 0, tolerance);
  EXPECT_NEAR(extent.center()[1 - side], 0, 2e-3f);  // a pixel of a thousand
}

TEST(FrameScene, TheSceneFillsTheFrameAndIsInItsMiddle) {
  for (const V3f& size : {V3f(1, 1, 1), V3f(30, 1, 2), V3f(1, 50, 1), V3f(1, 2, 80)}) {
    for (const float aspect : {0.5f, 1.0f, 16.0f / 9}) {
      const Scene scene = triangle_at({7, 8, 9}, size);
      const Camera camera = frame_scene(scene, aspect, 0.6f);
      SCOPED_TRACE(testing::Message() << size << " at " << aspect);
      expect_framed(camera, aspect, scene.meshes[0].positions);
      EXPECT_GT(camera.to_world[3][1], scene_bounds(scene).center().y);  // it looks down
    }
  }
}

TEST(FrameScene, ASceneFarFromTheOriginIsInTheMiddleToo) {
  for (const float away : {-1e5f, 3e4f, 1e5f}) {
    const Scene scene = triangle_at({away, 0, away}, {100, 10, 100});
    const Camera camera = frame_scene(scene, 16.0f / 9);
    SCOPED_TRACE(away);
    const Imath::Box2f extent = extent_in_frame(camera, 16.0f / 9, scene.meshes[0].positions);
    EXPECT_NEAR(extent.center().x, 0, 5e-3f);  // coordinates have steps of 8 mm
    EXPECT_NEAR(extent.center().y, 0, 5e-3f);
  }
}

// The corners of a tree's box are far outside of its crown. They must not make it smaller.
TEST(FrameScene, EmptyCornersOfTheBoundsDoNotMatter) {
  Scene scene = triangle_at({0, 0, 0}, {1, 1, 1});
  std::vector<V3f>& points = scene.meshes[0].positions;
  points = {{0, 0, 0}, {0, 2, 0}, {0, 1, 1}, {0, 1, -1}, {1, 1, 0}, {-1, 1, 0}};
  scene.meshes[0].indices = {0, 2, 4, 1, 3, 5};
  scene.meshes[0].materials = {0, 0};
  expect_framed(frame_scene(scene, 1), 1, points);
}

TEST(FrameScene, InstancesAreFramedWhereTheyAre) {
  Scene scene = triangle_at({0, 0, 0}, {1, 1, 1});
  scene.instances[0].to_world.setTranslation(V3f(100, 0, -20));
  std::vector<V3f> points = scene.meshes[0].positions;
  for (V3f& point : points) point = point * scene.instances[0].to_world;
  expect_framed(frame_scene(scene, 1.5f), 1.5f, points);
}

TEST(FrameScene, WhatIsScaledToNothingIsNotFramed) {
  Scene scene = triangle_at({0, 0, 0}, {1, 1, 1});
  const std::vector<V3f> points = scene.meshes[0].positions;
  const Box3f bounds = scene_bounds(scene);
  scene.instances.push_back(scene.instances[0]);
  scene.instances[1].to_world = M44f().setScale(0.0f) * M44f().setTranslation(V3f(0, -100, 0));
  EXPECT_EQ(scene_bounds(scene), bounds);
  expect_framed(frame_scene(scene, 1.5f), 1.5f, points);
}

TEST(FrameScene, ALongSceneIsSeenFromItsSide) {
  const auto back = [](const V3f& size) {
    const Camera camera = frame_scene(triangle_at({0, 0, 0}, size), 1.5f);
    return V3f(camera.to_world[2][0], 0, camera.to_world[2][2]).normalized();
  };
  EXPECT_TRUE(back({1, 5, 4}).equalWithAbsError(V3f(1, 0, 0), 1e-6f));
  EXPECT_TRUE(back({1, 5, 1.9f}).equalWithAbsError(V3f(0, 0, 1), 1e-6f));
  EXPECT_TRUE(back({9, 5, 1}).equalWithAbsError(V3f(0, 0, 1), 1e-6f));
}

TEST(LookAt, TakesVectorsWhoseSquaresAreNoFloats) {
  const Camera near = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 1);
  const Camera far = look_at({0, 0, 3e30f}, {0, 0, 0}, {0, 1e30f, 0}, 1);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      EXPECT_EQ(far.to_world[row][column], near.to_world[row][column]);
}

TEST(FrameScene, ASceneWithoutExtentStillGetsACamera) {
  const Camera camera = frame_scene(Scene{}, 1.5f);
  EXPECT_TRUE(std::isfinite(camera.to_world[3][2]));
  EXPECT_NE(camera.to_world.determinant(), 0);
}

TEST(LookAt, LooksAlongMinusZWithARightHandedOrthonormalFrame) {
  const Camera camera = look_at({1, 2, 3}, {4, 0, -5}, {0, 1, 0}, 0.5f);
  EXPECT_NEAR(camera.to_world.determinant(), 1, 1e-5);
  const V3f ahead = V3f(0, 0, -1) * camera.to_world - V3f(1, 2, 3);
  EXPECT_TRUE(ahead.equalWithAbsError(V3f(3, -2, -8).normalized(), 1e-6f));
  EXPECT_EQ(camera.to_world[0][1], 0);  // +X is level
  EXPECT_GT(camera.to_world[1][1], 0);
  EXPECT_EQ(camera.fov_y, 0.5f);
}

TEST(LookAt, DegenerateViewsAreRefused) {
  const V3f up(0, 1, 0);
  const auto refused = [](V3f from, V3f at, V3f up_, float fov_y) -> std::string {
    try {
      look_at(from, at, up_, fov_y);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(refused({1, 2, 3}, {1, 2, 3}, up, 1), "camera: from and at are the same point");
  EXPECT_EQ(refused({0, 5, 0}, {0, 0, 0}, up, 1),
            "camera: up is zero or points along the view; choose another");
  EXPECT_EQ(refused({0, 0, 5}, {0, 0, 0}, {0, 0, 0}, 1),
            "camera: up is zero or points along the view; choose another");
  EXPECT_EQ(refused({kInfinity, 0, 0}, {0, 0, 0}, up, 1), "camera: from, at and up must be finite");
  EXPECT_NE(refused({0, 0, 5}, {0, 0, 0}, up, 0).find("field of view"), std::string::npos);
}

}  // namespace
}  // namespace dapple
