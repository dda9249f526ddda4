// What refitting keeps and motion may change: which vertices coincide, and what covers what.
#include "bvh/refit/vertex_places.hpp"

#include <gtest/gtest.h>

#include <string>

#include "bvh/refit/refit_record.hpp"
#include "dapple/bvh.hpp"

namespace dapple {
namespace {

/// Separate squares of a wall, each moved aside by up to `apart` of its side.
Scene panels(float apart) {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  constexpr std::uint32_t kSide = 20;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<float>(i % kSide), y = static_cast<float>(i / kSide);
    const float shift = apart * static_cast<float>(i * 7919 % 101) / 101;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const V3f& corner : {V3f(0, 0, 0), V3f(1, 0, 0), V3f(1, 1, 0), V3f(0, 1, 0)})
      mesh.positions.push_back(corner + V3f(x + shift, y - shift, shift));
    for (const std::uint32_t k : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + k);
  }
  mesh.materials.assign(mesh.indices.size() / 3, 0);
  scene.meshes.push_back(std::move(mesh));
  scene.instances.emplace_back();
  return scene;
}

std::string bytes_of(const SceneBvh& bvh) {
  return {reinterpret_cast<const char*>(bvh.nodes.data()), bvh.nodes.size() * sizeof(BvhNode)};
}

// What touches decides what is a wall, and refitting keeps that.
TEST(Refit, PanelsThatMotionJoinsOrPartsAreBuiltAgain) {
  UpdatableBvh bvh(panels(0.01f));
  EXPECT_EQ(bvh.update(panels(0.011f)).objects_refitted, 1u);
  EXPECT_EQ(bvh.update(panels(0)).objects_rebuilt, 1u);
  const UpdatableBvh fresh(panels(0));
  EXPECT_EQ(bytes_of(bvh.bvh()), bytes_of(fresh.bvh()));
  EXPECT_EQ(bvh.update(panels(0.01f)).objects_rebuilt, 1u);
}

TEST(Refit, TheShareOfPlacesIsThatOfDifferentPositions) {
  for (const float apart : {0.01f, 0.0f}) {
    const Scene scene = panels(apart);
    const double expected = apart > 0 ? 1 : 21.0 * 21 / 1600;
    EXPECT_NEAR(share_of_places(scene.meshes[0].positions), expected, 0.01);
  }
  EXPECT_EQ(share_of_places({}), 1);
}

TEST(Refit, TheShareOfManyLayersIsKept) {
  for (const int layers : {1, 38, 114, 1000}) {
    KeptOpacity kept;
    const auto n = static_cast<float>(layers);
    kept.keep(3, V3f(1), {V3f(0), V3f(0), V3f(n)}, Box3f(V3f(0), V3f(1)), 1);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(n * kept.share(axis, 3), 1, 0.02);
  }
}

}  // namespace
}  // namespace dapple
