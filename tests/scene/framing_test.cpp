// The default camera of a scene that has none frames the scene's bounds. Also look_at(), and the
// views that it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

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

// Distance of a point from the picture's centre, in half widths or half heights of the frame (the
// larger of both): at most 1 inside the frame, infinite behind the camera.
float frame_excess(const Camera& camera, float aspect, V3f point) {
  const V3f p = point * camera.to_world.inverse();
  const float tan_y = std::tan(camera.fov_y / 2);
  if (p.z >= 0) return kInfinity;
  return std::max(std::abs(p.x / p.z) / (tan_y * aspect), std::abs(p.y / p.z) / tan_y);
}

TEST(FrameScene, EveryCornerOfTheBoundsIsInTheFrameAndOneIsNearItsEdge) {
  for (const V3f& size : {V3f(1, 1, 1), V3f(30, 1, 2), V3f(1, 50, 1), V3f(1, 2, 80)}) {
    for (const float aspect : {0.5f, 1.0f, 16.0f / 9}) {
      const Scene scene = triangle_at({7, 8, 9}, size);
      const Box3f box = scene_bounds(scene);
      const Camera camera = frame_scene(scene, aspect, 0.6f);
      float widest = 0;
      for (const float x : {box.min.x, box.max.x}) {
        for (const float y : {box.min.y, box.max.y}) {
          for (const float z : {box.min.z, box.max.z}) {
            widest = std::max(widest, frame_excess(camera, aspect, {x, y, z}));
          }
        }
      }
      EXPECT_LE(widest, 1);
      EXPECT_GT(widest, 0.9f);
      EXPECT_GT(camera.to_world[3][1], box.center().y);  // a little above the centre
    }
  }
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
  EXPECT_EQ(refused({0, 5, 0}, {0, 0, 0}, up, 1), "camera: up is zero or points along the view");
  EXPECT_EQ(refused({0, 0, 5}, {0, 0, 0}, {0, 0, 0}, 1),
            "camera: up is zero or points along the view");
  EXPECT_EQ(refused({kInfinity, 0, 0}, {0, 0, 0}, up, 1), "camera: from, at and up must be finite");
  EXPECT_NE(refused({0, 0, 5}, {0, 0, 0}, up, 0).find("field of view"), std::string::npos);
}

}  // namespace
}  // namespace dapple
