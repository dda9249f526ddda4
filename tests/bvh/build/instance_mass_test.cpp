// Where an instance has its mass: the mass pole of its world box turns and is mirrored with it.
#include <gtest/gtest.h>

#include <numbers>

#include "dapple/shared/bvh_node.h"
#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/smooth_shapes.hpp"

namespace dapple {
namespace {

/// Small leaves near the corner (-1, -1, -1), and one at the opposite corner.
Mesh leaves_in_a_corner() {
  Mesh mesh;
  scene_test::Points points(3);
  const auto add = [&](const V3f& at) {
    scene_test::append_grid(mesh, at, 0.1f * points.in_cube(1), 0.1f * points.in_cube(1), 1, 0);
  };
  for (int i = 0; i < 400; ++i) add(0.25f * points.in_cube(1) - V3f(0.75f, 0.75f, 0.75f));
  add({0.95f, 0.95f, 0.95f});
  return mesh;
}

/// The mass pole that the top level stores of the only instance.
V3f pole_of_instance(const M44f& to_world) {
  Scene scene = test::scene_of(leaves_in_a_corner());
  scene.instances.at(0).to_world = to_world;
  const SceneBvh bvh = build_bvh(scene);
  EXPECT_TRUE(bvh.has_top);
  const BvhNode& root = bvh.nodes[bvh.root];
  EXPECT_GT(bvh_mass_concentration(root.leaf_end, 0), 0);
  return {bvh_mass_pole(root.correlation, 0, 0), bvh_mass_pole(root.correlation, 1, 0),
          bvh_mass_pole(root.correlation, 2, 0)};
}

TEST(InstanceMass, ThePoleTurnsAndIsMirroredWithTheInstance) {
  M44f moved, turned, mirrored;
  moved.setTranslation(V3f(3, 1, -2));
  turned.rotate(V3f(0, std::numbers::pi_v<float>, 0));
  mirrored.setScale(V3f(1, -2, 1));
  EXPECT_EQ(pole_of_instance(moved), V3f(-0.75f, -0.75f, -0.75f));
  EXPECT_EQ(pole_of_instance(turned), V3f(0.75f, -0.75f, 0.75f));
  EXPECT_EQ(pole_of_instance(mirrored), V3f(-0.75f, 0.75f, -0.75f));
}

}  // namespace
}  // namespace dapple
