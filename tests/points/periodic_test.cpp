// Scenes that repeat: where the copies are, and that they do not emit.
#include "points/periodic.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

// Lights are of the scene, not of what surrounds it: a lamp that every copy repeats would be
// brighter.
TEST(Periodic, CopiesLieOnTheGridAndDoNotEmit) {
  Scene scene;
  scene.materials.push_back(material_of(1));
  Mesh post;
  append_grid(post, {0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}, 1, 0);
  M44f at;
  at.setTranslation(V3f(0.25f, 0, 0));
  place(scene, std::move(post), at, 0);
  scene.lights.emplace_back().kind = LightKind::mesh;
  repeat(scene, 8, 16);
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

}  // namespace
}  // namespace dapple
