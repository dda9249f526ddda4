// What scenes by name that bring their own light and camera have in common.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::scene_test {

/// Expects a sun, a sky, and one camera that sees all `points` in a picture of 960x540 pixels.
inline void expect_daylight_and_a_view_of(const Scene& scene, const std::vector<V3f>& points) {
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].kind, LightKind::sun);
  EXPECT_EQ(scene.lights[1].kind, LightKind::dome);
  ASSERT_EQ(scene.cameras.size(), 1u);
  ASSERT_FALSE(points.empty());
  const M44f to_camera = scene.cameras[0].to_world.inverse();
  const float tan_y = std::tan(scene.cameras[0].fov_y / 2);
  for (const V3f& p : points) {
    const V3f q = p * to_camera;
    ASSERT_LT(q.z, 0);
    ASSERT_LE(std::abs(q.y / q.z), tan_y);
    ASSERT_LE(std::abs(q.x / q.z), tan_y * 960 / 540);
  }
}

}  // namespace dapple::scene_test
