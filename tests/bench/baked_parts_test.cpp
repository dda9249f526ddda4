// The parts of meshes that the protocol "bake" of `dapple-bench rivals` bakes: which triangles they
// have, and that their vertices have the values of the whole mesh.
#include "rivals/protocols/baked_parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "bake/vertex_bake.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple::bench {
namespace {

using namespace scene_test;

/// Square cards apart from each other, of two triangles each, that share two vertices.
Mesh cards(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i)
    append_grid(mesh, {2.0f * static_cast<float>(i), 0, 0}, {1, 0, 0}, {0, 0, 1}, 1, 0);
  return mesh;
}

Scene scene_of(const std::vector<Mesh>& meshes) {
  Scene scene;
  scene.materials.resize(1);
  for (const Mesh& mesh : meshes) place(scene, mesh);
  return scene;
}

TEST(BakedParts, TrianglesAreSpreadOverAllMeshes) {
  Scene scene = scene_of({cards(50), cards(150)});
  scene.instances.push_back(scene.instances[1]);
  const std::vector<BakedPart> parts = choose_parts(scene, 8);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].compared.size(), 2u * 3) << "a quarter of the triangles";
  EXPECT_EQ(parts[1].compared.size(), 6u * 3);
  EXPECT_EQ(parts[0].placements.to_world.size(), 1u);
  EXPECT_EQ(parts[1].placements.to_world.size(), 2u);
}

TEST(BakedParts, CardsAreTakenAsAWhole) {
  const std::vector<BakedPart> parts = choose_parts(scene_of({cards(10)}), 1);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].mesh.primitive_count(), 2u);
  EXPECT_EQ(parts[0].mesh.positions.size(), 4u);
  EXPECT_EQ(parts[0].two_sided.size(), 2u);
  EXPECT_EQ(parts[0].compared, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(BakedParts, WhatIsNotPlacedAndStrandsHaveNone) {
  Scene scene = scene_of({cards(10), cards(10), cards(10)});
  scene.instances.erase(scene.instances.begin());
  scene.meshes[1].radii.resize(scene.meshes[1].positions.size(), 0.1f);
  const std::vector<BakedPart> parts = choose_parts(scene, 1000);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].mesh.primitive_count(), 20u);
  EXPECT_EQ(parts[0].compared.size(), 40u) << "all of its vertices";
}

/// A sheet of 800 triangles that is not flat: no small part.
Mesh hills() {
  Mesh mesh = square_mesh(20, 0, 20, 0);
  Points random(3);
  for (V3f& p : mesh.positions) p.y = 0.8f * random.unit();
  return mesh;
}

/// AO at vertices where each sample sees as much as its triangle's normal says.
std::vector<float> baked_by_slope(const Mesh& mesh, const std::vector<bool>& two_sided,
                                  const Placements& placements) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 512;
  options.normals = Normals::geometric;
  const TracePoints by_slope = [](const QueryPoints& points, const OcclusionOptions&, bool) {
    PointOcclusion found;
    for (const V3f& normal : points.normals) found.ao.push_back(0.5f + 0.5f * normal.x);
    return found;
  };
  BakeStatistics statistics;
  const RenderControl control;
  BakeProgress progress(1, control);
  const TraceSamples ao = ao_tracer(by_slope, options);
  BakeTracing tracing{{ao, ao}, {}, 0, progress, statistics};
  return bake_mesh(mesh, two_sided, 0, placements, options, tracing)->ao;
}

TEST(BakedParts, TheirVerticesHaveTheValuesOfTheWholeMesh) {
  const Scene scene = scene_of({hills()});
  const Mesh& mesh = scene.meshes[0];
  const std::vector<BakedPart> parts = choose_parts(scene, 10);
  ASSERT_EQ(parts.size(), 1u);
  const BakedPart& part = parts[0];
  EXPECT_LT(part.mesh.primitive_count(), 10u * 14);
  Placements placements;
  placements.add(M44f());
  const std::vector<bool> one_sided(mesh.primitive_count(), false);
  const std::vector<float> whole = baked_by_slope(mesh, one_sided, placements);
  const std::vector<float> of_part = baked_by_slope(part.mesh, part.two_sided, part.placements);
  const auto key = [](const V3f& p) { return std::tuple(p.x, p.y, p.z); };
  std::map<std::tuple<float, float, float>, float> expected;
  for (std::size_t v = 0; v < whole.size(); ++v) expected[key(mesh.positions[v])] = whole[v];
  EXPECT_EQ(part.compared.size(), 30u);
  for (const std::uint32_t v : part.compared)
    EXPECT_NEAR(of_part[v], expected.at(key(part.mesh.positions[v])), 0.01) << v;
}

}  // namespace
}  // namespace dapple::bench
