// Placements that are scaled to zero: they are not in the scene, and count for no baked value.
#include "bake/mesh_placements.hpp"

#include <gtest/gtest.h>

#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// A small plane under a disk that covers half of its sky, and `vanished` placements of both that
/// are scaled to zero, the first one before the others.
Scene plane_under_disk(std::size_t vanished) {
  Scene scene = make_procedural("scene:disk?radius=1&height=1&opacity=1");
  const std::uint32_t disk = scene.instances.at(0).mesh;
  Mesh plane;
  append_grid(plane, {-0.02f, 0, -0.02f}, {0, 0, 0.04f}, {0.04f, 0, 0}, 2, 0);
  const auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
  scene.meshes.push_back(plane);
  for (const std::uint32_t m : {mesh, disk}) {
    Instance placed;
    placed.mesh = m;
    if (m == mesh) scene.instances.push_back(placed);
    placed.to_world.scale(V3f(0, 0, 0));
    for (std::size_t i = 0; i < vanished; ++i)
      scene.instances.insert(i == 0 ? scene.instances.begin() : scene.instances.end(), placed);
  }
  return scene;
}

BakeOptions exact() {
  BakeOptions options;
  options.estimator = Estimator::exact;
  options.sides = BakeSides::front;
  options.target_error = 0;
  options.rays = 2048;
  return options;
}

TEST(MeshPlacements, ThoseThatAreScaledToZeroDoNotCountAtVertices) {
  for (const std::size_t vanished : {0, 1, 6}) {
    const Scene scene = plane_under_disk(vanished);
    const std::size_t mesh = scene.meshes.size() - 1;
    EXPECT_EQ(placement_counts(scene, BakePlacement::together)[mesh], 1u);
    const BakeResult baked = bake(scene, exact());
    for (const float ao : not_empty(baked.meshes.at(mesh).ao))
      EXPECT_NEAR(ao, 0.5, 0.01) << vanished;
  }
}

TEST(MeshPlacements, ThoseThatAreScaledToZeroDoNotCountForTexelsAndTheirSize) {
  BakeOptions options = exact();
  options.vertices = false;
  options.texture = true;
  options.texture_size = 32;
  options.rays = 256;
  const BakedTexture before = bake(plane_under_disk(0), options).texture;
  const BakedTexture after = bake(plane_under_disk(3), options).texture;
  EXPECT_EQ(after.layout.corners, before.layout.corners);
  for (std::size_t i = 0; i < before.ao.size(); ++i)
    ASSERT_NEAR(after.ao[i], before.ao[i], 0.03) << i;
}

// A plane beside a wall on its left, and a tenth as large beside one on its right.
TEST(MeshPlacements, BentNormalsOfLargeAndSmallOnesCountTheSame) {
  Scene scene;
  scene.materials.resize(1);
  place(scene, square_mesh(0.02f, 0, 1, 0));
  Mesh wall;
  append_grid(wall, {-0.05f, 0, -5}, {0, 5, 0}, {0, 0, 10}, 1, 0);
  place(scene, wall);
  for (std::uint32_t mesh : {0u, 1u}) {
    Instance mirrored;
    mirrored.mesh = mesh;
    mirrored.to_world.setScale(mesh == 0 ? V3f(0.1f) : V3f(-0.1f, 0.1f, 0.1f));
    mirrored.to_world[3][0] = 100;
    scene.instances.push_back(mirrored);
  }
  BakeOptions options = exact();
  options.bent = true;
  const BakeResult baked = bake(scene, options);
  for (const V3f& bent : baked.meshes.at(0).bent) EXPECT_NEAR(bent.x, 0, 0.03);
}

TEST(MeshPlacements, StrandsAreNotBakedAndTold) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 8;
  const BakeResult baked = bake(make_procedural("scene:hair?strands=20"), options);
  const std::vector<std::string>& notes = baked.statistics.notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(), "1 mesh of strands: not baked"), 1);
}

TEST(MeshPlacements, MeshesThatAreAlwaysScaledToZeroAreNotBakedAndTold) {
  Scene scene = plane_under_disk(0);
  const std::size_t mesh = scene.meshes.size() - 1;
  for (Instance& instance : scene.instances)
    if (instance.mesh == mesh) instance.to_world.scale(V3f(0, 1, 1));
  const BakeResult baked = bake(scene, exact());
  EXPECT_TRUE(baked.meshes.at(mesh).ao.empty());
  const std::vector<std::string>& notes = baked.statistics.notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(),
                       "1 mesh without an instance whose matrix can be inverted: not baked"),
            1);
  BakeOptions options = exact();
  options.texture = true;
  options.texture_size = 32;
  options.rays = 8;
  EXPECT_TRUE(bake(scene, options).texture.layout.corners.at(mesh).empty());
  options.texture = false;
  options.placement = BakePlacement::alone;
  EXPECT_FALSE(bake(scene, options).meshes.at(mesh).ao.empty()) << "alone, it has no matrix";
}

TEST(MeshPlacements, InstancesThatAreScaledToZeroHaveNoSamples) {
  BakeOptions options = exact();
  options.vertices = false;
  options.instances = true;
  const BakeResult few = bake(plane_under_disk(0), options);
  const BakeResult more = bake(plane_under_disk(5), options);
  EXPECT_EQ(more.statistics.rays, few.statistics.rays);
  EXPECT_EQ(more.statistics.instances, few.statistics.instances);
}

}  // namespace
}  // namespace dapple
