// When refitting has spoilt a BVH: objects are built anew then, and only then.
#include "bvh/refit/traversal_cost.hpp"

#include <gtest/gtest.h>

#include "dapple/bvh.hpp"
#include "support/scenes/scattered_tree.hpp"

namespace dapple {
namespace {

Scene tree() { return make_procedural("scene:tree?leaves=5000"); }

/// The tree with its leaves scattered, and the first triangle `up` metres higher.
Scene scattered(const Scene& still, float up) {
  Scene scene = motion::scattered(still, 2);
  Mesh& mesh = scene.meshes[0];
  for (std::size_t k = 0; k < 3; ++k) mesh.positions[mesh.indices[k]].y += up;
  return scene;
}

TEST(TraversalCost, ATriangleFarAwayDoesNotHideThatATreeHasDecayed) {
  const Scene still = tree();
  double near = 0;
  for (const float up : {0.0f, 60.0f, 3000.0f}) {
    UpdatableBvh bvh(still);
    const BvhUpdate update = bvh.update(scattered(still, up));
    EXPECT_EQ(update.objects_rebuilt, 1u) << up;
    if (up == 0) near = update.cost_ratio;
    EXPECT_GT(update.cost_ratio, 0.8 * near) << up;
  }
}

TEST(TraversalCost, WhatGrowsFliesAwayOrLosesATriangleIsNotBuiltAnew) {
  const Scene still = tree();
  Scene larger = still, parted = still;
  for (V3f& p : larger.meshes[0].positions) p = p * 7.0f + V3f(100, -50, 3);
  for (std::size_t k = 0; k < 3; ++k)
    parted.meshes[0].positions[parted.meshes[0].indices[k]].y += 3000;
  const Scene scenes[] = {larger, parted};
  for (const Scene& moved : scenes) {
    UpdatableBvh bvh(still);
    const BvhUpdate update = bvh.update(moved);
    EXPECT_EQ(update.objects_refitted, 1u);
    // Boxes above the triangle that left hold the whole tree, and rays visit them.
    EXPECT_LT(update.cost_ratio, &moved == &scenes[0] ? 1.1 : 1.5);
  }
}

TEST(TraversalCost, OfAMeshThatIsAPointIsThatOfItsRoot) {
  Mesh mesh;
  mesh.positions.assign(3, V3f(1, 2, 3));
  EXPECT_EQ(traversal_cost({}, mesh), 1);
}

}  // namespace
}  // namespace dapple
