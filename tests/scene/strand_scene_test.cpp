// Strands in a scene before the BVH is built: they are merged apart from triangles, and segments
// that no ray can hit are dropped and counted in a warning. Strands are not written as glTF, and do
// not emit light.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "dapple/error.hpp"
#include "support/scenes/curly_strands.hpp"

namespace dapple {
namespace {

using namespace scene_test;

bool warns(const Scene& scene, const std::string& text) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

TEST(StrandScene, StrandsAndTrianglesAreMergedApart) {
  Scene scene = strand_scene(curly_strands({.strands = 3}), 0.3f);
  place(scene, curly_strands({.strands = 4}));
  place(scene, square_mesh(1, 0, 2, 0));
  place(scene, square_mesh(2, 1, 2, 0));
  merge_single_instances(scene);
  ASSERT_EQ(scene.meshes.size(), 2u);
  std::size_t segments = 0, triangles = 0;
  for (const Mesh& mesh : scene.meshes)
    (mesh.has_strands() ? segments : triangles) += mesh.primitive_count();
  EXPECT_EQ(segments, 7u * 16);
  EXPECT_EQ(triangles, 16u);
}

TEST(StrandScene, StrandsThatAPlacementWouldFlattenStayInstances) {
  Scene scene = strand_scene(curly_strands({.strands = 3}), 0.3f);
  scene.instances[0].to_world.scale(V3f(1, 2, 1));
  merge_single_instances(scene);
  EXPECT_EQ(scene.instances[0].to_world[1][1], 2.0f);
  EXPECT_EQ(scene.meshes[0].radii[0], 0.002f);
}

// Two segments without length in a row, in either order.
TEST(StrandScene, SegmentsWithoutLengthLeaveNoGap) {
  for (const bool backwards : {false, true}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.radii.assign(5, 0.01f);
    mesh.materials.assign(4, 0);
    for (const std::uint32_t s : {0u, 1u, 2u, 3u}) {
      const std::uint32_t first = backwards ? 3 - s : s;
      mesh.indices.insert(mesh.indices.end(), {first, first + 1});
    }
    Scene scene = strand_scene(std::move(mesh), 1);
    merge_single_instances(scene);
    const std::vector<std::uint32_t>& kept = scene.meshes.at(0).indices;
    ASSERT_EQ(kept.size(), 4u);
    EXPECT_EQ(std::set<std::uint32_t>(kept.begin(), kept.end()).size(), 3u) << backwards;
  }
}

TEST(StrandScene, RadiiScaleWithASingleInstance) {
  Scene scene = strand_scene(curly_strands({.strands = 3}), 0.3f);
  scene.instances[0].to_world.scale(V3f(3, 3, 3));
  merge_single_instances(scene);
  EXPECT_EQ(scene.instances[0].to_world, M44f());
  EXPECT_FLOAT_EQ(scene.meshes[0].radii[0], 0.006f);
}

TEST(StrandScene, SegmentsThatNothingCanHitAreDroppedWithACountAndStrandsGoOnAcrossThem) {
  Mesh mesh;
  // The second segment has no length. The last has no radius; the one before it ends in a point.
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  mesh.radii = {0.1f, 0.1f, 0.1f, 0.1f, 0, 0};
  for (std::uint32_t i = 0; i < 5; ++i) {
    mesh.indices.insert(mesh.indices.end(), {i, i + 1});
    mesh.materials.push_back(0);
  }
  mesh.positions.push_back({0, std::numeric_limits<float>::quiet_NaN(), 0});
  mesh.radii.push_back(0.1f);
  mesh.indices.insert(mesh.indices.end(), {0, 6});
  mesh.materials.push_back(0);
  Scene scene = strand_scene(mesh, 0.5f);
  merge_single_instances(scene);
  EXPECT_TRUE(warns(scene, "dropped 1 segment without a length"));
  EXPECT_TRUE(warns(scene, "dropped 1 segment without a radius"));
  EXPECT_TRUE(warns(scene, "dropped 1 segment with non-finite"));
  const std::vector<std::uint32_t> chain{0, 1, 1, 2, 2, 3};
  EXPECT_EQ(scene.meshes[0].indices, chain);
  EXPECT_EQ(scene.meshes[0].radii.size(), 4u);
}

TEST(StrandScene, BoundsHoldTheirThickness) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  mesh.radii = {0.1f, 0.1f};
  mesh.indices = {0, 1};
  mesh.materials = {0};
  const Box3f box = scene_bounds(strand_scene(mesh, 1));
  EXPECT_FLOAT_EQ(box.max.y, 0.1f);
  EXPECT_FLOAT_EQ(box.min.x, -0.1f);
}

TEST(StrandScene, StrandsAreNotWrittenAsGltf) {
  const Scene scene = strand_scene(curly_strands({.strands = 1}), 1);
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("dapple_strands_" + std::to_string(getpid()) + ".glb"))
                               .string();
  std::filesystem::remove(path);
  EXPECT_THROW(write_glb(scene, path), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(StrandScene, StrandsDoNotEmitAndAWarningSaysSo) {
  Scene scene = strand_scene(curly_strands({.strands = 1}), 1);
  Light glow;
  glow.name = "glow";
  glow.kind = LightKind::mesh;
  scene.lights.push_back(glow);
  scene.instances[0].light = 0;
  merge_single_instances(scene);
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_TRUE(warns(scene, "1 instance of strands should emit light"));
}

// Whether they can be merged depends on their scale, which may differ from frame to frame.
TEST(StrandScene, StrandsOfScenesThatMoveStayPlaced) {
  for (const bool moves : {false, true}) {
    Scene scene = strand_scene(curly_strands({.strands = 3}), 0.3f);
    place(scene, curly_strands({.strands = 4}));
    if (moves) scene.animations.emplace_back();
    merge_single_instances(scene);
    EXPECT_EQ(scene.instances.size(), moves ? 2u : 1u);
  }
}

TEST(StrandScene, StatisticsCountSegmentsApartFromTriangles) {
  Scene scene = strand_scene(curly_strands({.strands = 10}), 0.3f);
  place(scene, square_mesh(1, 0, 1, 0));
  scene.instances.push_back({0, M44f().setTranslation(V3f(3, 0, 0)), -1});
  const SceneBvh bvh = build_bvh(scene);
  EXPECT_EQ(bvh.statistics.segments, 160u);
  EXPECT_EQ(bvh.statistics.instanced_segments, 320u);
  EXPECT_EQ(bvh.statistics.triangles, 2u);
  EXPECT_EQ(bvh.statistics.translucent, 2u);
}

}  // namespace
}  // namespace dapple
