// bake(): AO at vertices against closed forms, the side of a surface that counts, vertices inside
// closed geometry, instances, and equal bits in every run.
#include "dapple/bake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "dapple/error.hpp"
#include "support/not_empty.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

Material opaque(bool double_sided) {
  Material material;
  material.name = double_sided ? "leaf" : "bark";
  material.double_sided = double_sided;
  return material;
}

// A horizontal grid of side `side` at `height` whose front side is up.
Mesh grid(float side, float height, std::uint32_t cells) {
  Mesh mesh;
  append_grid(mesh, {-side / 2, height, -side / 2}, {0, 0, side}, {side, 0, 0}, cells, 0);
  return mesh;
}

std::size_t vertex_near(const Mesh& mesh, const V3f& point) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if ((mesh.positions[i] - point).length2() < (mesh.positions[best] - point).length2()) best = i;
  return best;
}

BakeOptions many_rays() {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 8192;
  options.estimator = Estimator::exact;
  return options;
}

// Many programs write all materials as double-sided: a ground still has the AO of its upper side,
// also if it is a single quad, and a leaf that of its better lit one.
TEST(Bake, GroundsHaveTheirFrontAlthoughTheirMaterialIsDoubleSided) {
  for (const std::uint32_t cells : {1u, 40u}) {
    Scene scene;
    scene.materials = {opaque(true)};
    scene.meshes = {grid(4, 0, cells), grid(4, 0.01f, cells), grid(0.1f, 0.02f, 1)};
    for (std::uint32_t m = 0; m < 3; ++m) scene.instances.push_back({m, M44f()});
    BakeOptions options = many_rays();
    options.rays = 256;
    const BakeResult front = bake(scene, options);
    for (const float ao : not_empty(front.meshes.at(0).ao)) EXPECT_LT(ao, 0.6f) << cells;
    for (const float ao : not_empty(front.meshes.at(2).ao)) EXPECT_GT(ao, 0.99f);
    options.sides = BakeSides::max;
    const BakeResult brighter = bake(scene, options);
    for (const float ao : not_empty(brighter.meshes.at(0).ao)) EXPECT_GT(ao, 0.99f) << cells;
  }
}

TEST(Bake, APlaneUnderADiskHasTheClosedFormOnItsAxis) {
  // Below the middle of a disk of radius 2 at height 1 and opacity 0.85: 1 - 0.85 r^2 / (r^2 +
  // h^2).
  const Scene disk = make_procedural("scene:disk?radius=2&height=1&opacity=0.85");
  Scene plane;
  plane.materials = {opaque(false)};
  plane.meshes = {grid(0.02f, 0, 2)};
  plane.instances.resize(1);
  for (const bool at_vertices : {false, true}) {
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
      BakeOptions options = many_rays();
      options.estimator = estimator;
      options.at_vertices = at_vertices;
      const BakeResult result = bake(plane, options, {}, {disk});
      ASSERT_EQ(result.meshes.at(0).ao.size(), plane.meshes[0].positions.size());
      const std::size_t middle = vertex_near(plane.meshes[0], V3f(0, 0, 0));
      // 8,192 rays: strata on the rim err by about 0.002. Prefiltered: see closed_form_test.cpp.
      EXPECT_NEAR(result.meshes[0].ao[middle], 1 - 0.85 * 0.8,
                  estimator == Estimator::exact ? 0.005 : 0.03)
          << at_vertices;
    }
  }
}

// A few samples are often equal by chance, which says nothing about their variance.
TEST(Bake, MeshesOfFewTrianglesReachTheirTargetToo) {
  const Scene disk = make_procedural("scene:disk?radius=4&height=0.1&opacity=1");
  Scene plane;
  plane.materials = {opaque(false)};
  plane.meshes = {grid(0.02f, 0, 1)};
  plane.instances.resize(3);  // one of them under the disk
  for (const std::size_t i : {1, 2})
    plane.instances[i].to_world.translate(V3f(100.0f * static_cast<float>(i), 0, 0));
  double squares = 0;
  constexpr int kSeeds = 40;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    BakeOptions options;
    options.seed = seed;
    options.report_bias = 0;
    options.estimator = Estimator::exact;
    const BakeResult result = bake(plane, options, {}, {disk});
    for (const float ao : not_empty(result.meshes.at(0).ao))
      squares += std::pow(double{ao} - 2.0 / 3, 2) / (4 * kSeeds);
  }
  // The target is 0.04. Samples that stopped after the first few were wrong by 0.14.
  EXPECT_LT(std::sqrt(squares), 0.09);
}

/// The largest error of AO at the vertices of two triangles with `placements`, of which one is
/// under a disk that covers 0.8 of its hemisphere.
float error_in_placements(std::size_t placements, bool at_vertices) {
  const Scene disk = make_procedural("scene:disk?radius=2&height=1&opacity=1");
  Scene plane;
  plane.materials = {opaque(false)};
  plane.meshes = {grid(0.02f, 0, 1)};
  plane.instances.resize(placements);
  for (std::size_t i = 1; i < placements; ++i)
    plane.instances[i].to_world.translate(V3f(1000.0f * static_cast<float>(i), 0, 0));
  BakeOptions options;
  options.target_error = options.report_bias = 0;
  options.rays = 16384;
  options.at_vertices = at_vertices;
  options.estimator = Estimator::exact;
  float largest = 0;
  const BakeResult baked = bake(plane, options, {}, {disk});
  for (const float ao : not_empty(baked.meshes.at(0).ao))
    largest = std::max(largest, std::fabs(ao - (1 - 0.8f / static_cast<float>(placements))));
  return largest;
}

// Of placements at random, 64 samples of a triangle would err by 0.04 with two, of one sample at a
// vertex by 0.4.
TEST(Bake, AllPlacementsCountEquallyIfTheNumberOfRaysIsGiven) {
  for (const bool at_vertices : {false, true})
    for (const std::size_t placements : {2, 5, 100})
      EXPECT_LT(error_in_placements(placements, at_vertices), 0.004f)
          << placements << (at_vertices ? " at vertices" : "");
}

TEST(Bake, AnOpenPlaneSeesTheWholeSkyAndItsBentNormalIsItsOwn) {
  Scene plane;
  plane.materials = {opaque(false)};
  plane.meshes = {grid(2, 0, 4)};
  plane.instances.resize(1);
  plane.instances[0].to_world.rotate(V3f(0.3f, 0.2f, 0.1f));
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    BakeOptions options;
    options.estimator = estimator;
    options.bent = true;
    const BakeResult result = bake(plane, options);
    // Exact: one ray in the plane itself may hit a neighbour, by rounding. Prefiltered: grazing
    // rays meet covered nodes of the plane.
    const double tolerance = estimator == Estimator::exact ? 0.001 : 0.025;
    for (std::size_t v = 0; v < result.meshes.at(0).ao.size(); ++v) {
      EXPECT_NEAR(result.meshes[0].ao[v], 1, tolerance) << v;
      EXPECT_GT(result.meshes[0].bent[v].dot(V3f(0, 1, 0)), 0.99f) << "in object space";
    }
    EXPECT_EQ(result.statistics.enclosed_vertices, 0u);
  }
}

// A small leaf that lies on a table: its lower side is dark, its upper side is not.
Scene leaf_on_table(bool double_sided) {
  Scene scene;
  scene.materials = {opaque(double_sided), opaque(false)};
  Mesh leaf = grid(0.1f, 0.001f, 1);
  std::swap(leaf.indices[1], leaf.indices[2]);  // the front sides look down
  std::swap(leaf.indices[4], leaf.indices[5]);
  Mesh table = grid(4, 0, 1);
  for (std::uint32_t& material : table.materials) material = 1;
  scene.meshes = {leaf, table};
  scene.instances.resize(2);
  scene.instances[1].mesh = 1;
  return scene;
}

float mean_of_leaf(const Scene& scene, BakeSides sides) {
  BakeOptions options = many_rays();
  options.sides = sides;
  const BakedMesh leaf = bake(scene, options).meshes.at(0);
  float sum = 0;
  for (const float ao : not_empty(leaf.ao)) sum += ao / static_cast<float>(leaf.ao.size());
  return sum;
}

TEST(Bake, SidesAreTheFrontTheBrighterOneOrTheMean) {
  const Scene scene = leaf_on_table(true);
  const float front = mean_of_leaf(scene, BakeSides::front);
  EXPECT_LT(front, 0.1f);
  EXPECT_NEAR(mean_of_leaf(scene, BakeSides::max), 1, 1e-5);
  EXPECT_NEAR(mean_of_leaf(scene, BakeSides::mean), 0.5 * (1 + front), 0.01);
  EXPECT_NEAR(mean_of_leaf(scene, BakeSides::automatic), 1, 1e-5) << "double-sided";
  EXPECT_LT(mean_of_leaf(leaf_on_table(false), BakeSides::automatic), 0.1f) << "single-sided";
}

// A sheet of which each triangle is there twice, once for each side: what is up is one's front and
// the other's back.
TEST(Bake, SheetsBackToBackHaveTheBrighterSideOfBoth) {
  Scene scene = leaf_on_table(true);
  append_grid(scene.meshes[0], {-0.05f, 0.001f, -0.05f}, {0, 0, 0.1f}, {0.1f, 0, 0}, 1, 0);
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(0, -1, 0);
  sun.angular_radius = 0.01f;
  sun.radiance = V3f(1 / (3.14159265f * 1e-4f));  // irradiance 1
  scene.lights = {sun};
  for (const bool at_vertices : {false, true}) {
    for (const bool texture : {false, true}) {
      BakeOptions options = many_rays();
      options.bent = options.light = true;
      options.at_vertices = at_vertices;
      options.texture = texture;
      options.texture_size = 32;
      const BakeResult result = bake(scene, options);
      for (std::size_t v = 0; v < 8; ++v) {
        EXPECT_NEAR(result.meshes.at(0).ao.at(v), 1, 1e-4) << v;
        EXPECT_GT(result.meshes[0].bent.at(v).y, 0.99f) << v;
        EXPECT_NEAR(result.meshes[0].light.at(0).at(v).x, 1, 0.01) << v;
      }
      // Texels of the table below the leaf are darker: 0.86.
      EXPECT_EQ(result.texture.ao.empty(), !texture);
      for (const float ao : result.texture.ao) EXPECT_GT(ao, 0.8f);
    }
  }
}

TEST(Bake, VerticesInsideClosedGeometryHaveTheirNeighboursValue) {
  // A strip of cells from far outside into a cube of side 1 about the origin.
  Scene scene = make_procedural("scene:cube?divisions=1");
  const Box3f cube = scene_bounds(scene);
  Scene strip;
  strip.materials = {opaque(true)};
  Mesh mesh;
  append_grid(mesh, {cube.center().x, cube.center().y, cube.center().z}, {20, 0, 0}, {0, 0, 0.01f},
              40, 0);
  strip.meshes = {mesh};
  strip.instances.resize(1);
  const BakeResult result = bake(strip, BakeOptions{}, {}, {scene});
  EXPECT_GT(result.statistics.enclosed_vertices, 0u);
  const std::size_t inside = vertex_near(mesh, cube.center());
  EXPECT_GT(result.meshes.at(0).ao[inside], 0.2f);
  const BakeResult alone = bake(strip, BakeOptions{});
  EXPECT_EQ(alone.statistics.enclosed_vertices, 0u);
  EXPECT_EQ(result.statistics.dark_vertices + alone.statistics.dark_vertices, 0u);
}

TEST(Bake, AClosedRoomIsDarkAndSaysSo) {
  Scene room = make_procedural("scene:cube?divisions=2");
  Mesh& mesh = room.meshes.at(0);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);  // the front sides look inwards
  BakeOptions options;
  options.sides = BakeSides::front;
  options.estimator = Estimator::exact;
  options.texture = true;
  options.texture_size = 64;
  BakeResult result = bake(room, options);
  EXPECT_EQ(result.statistics.dark_vertices, mesh.positions.size());
  EXPECT_EQ(result.statistics.enclosed_vertices + result.statistics.enclosed_texels, 0u);
  EXPECT_GT(result.statistics.dark_texels, 0u);
  for (const float ao : not_empty(result.meshes.at(0).ao)) EXPECT_EQ(ao, 0);
  options.distance = 1e-3f;
  result = bake(room, options);
  EXPECT_EQ(result.statistics.dark_vertices + result.statistics.dark_texels, 0u);
}

TEST(Bake, InstancesHaveTheValueOfTheirSurroundings) {
  Scene scene = leaf_on_table(true);
  scene.instances.push_back(scene.instances[0]);
  scene.instances.back().to_world.translate(V3f(0, -0.5f, 0));  // under the table
  Mesh lid = grid(4, -1, 1);  // and a floor below it: half of its sky is gone
  scene.meshes.push_back(lid);
  scene.instances.push_back({});
  scene.instances.back().mesh = 2;
  BakeOptions options = many_rays();
  options.instances = true;
  options.vertices = false;
  options.sides = BakeSides::mean;
  const BakeResult result = bake(scene, options);
  ASSERT_EQ(result.instance_ao.size(), 4u);
  EXPECT_TRUE(result.meshes.empty());
  EXPECT_NEAR(result.instance_ao[0], 0.5, 0.06);
  EXPECT_LT(result.instance_ao[2], 0.1f) << "between table and floor";
}

TEST(Bake, AMeshAloneIsNotOccludedByOthersAndTogetherItIsTheMeanOfItsPlacements) {
  Scene scene = leaf_on_table(true);
  scene.instances.push_back(scene.instances[0]);
  scene.instances.back().to_world.translate(V3f(0, 50, 0));
  BakeOptions options = many_rays();
  options.sides = BakeSides::front;
  const float together = bake(scene, options).meshes.at(0).ao[0];
  EXPECT_NEAR(together, 0.5, 0.2) << "one of two placements is dark";
  options.placement = BakePlacement::alone;
  EXPECT_EQ(bake(scene, options).meshes.at(0).ao[0], 1.0f);
}

TEST(Bake, OccludersOfMeshesAloneAreRefused) {
  const Scene scene = make_procedural("scene:cube");
  BakeOptions options;
  options.rays = 8;
  options.target_error = 0;
  options.placement = BakePlacement::alone;
  const std::vector<Scene> occluders{scene};
  try {
    bake(scene, options, {}, occluders);
    FAIL() << "a mesh alone has no occluders";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("--occluders needs"), std::string::npos);
  }
  options.vertices = false;
  options.instances = true;  // instances are in their surroundings
  EXPECT_EQ(bake(scene, options, {}, occluders).instance_ao.size(), 1u);
}

TEST(Bake, TheSameArgumentsGiveTheSameBits) {
  const Scene tree = make_procedural("scene:tree?leaves=2000");
  BakeOptions options;
  options.bent = true;
  options.rays = 32;
  const BakeResult first = bake(tree, options), again = bake(tree, options);
  for (std::size_t m = 0; m < first.meshes.size(); ++m) {
    EXPECT_EQ(first.meshes[m].ao, again.meshes[m].ao);
    EXPECT_EQ(std::memcmp(first.meshes[m].bent.data(), again.meshes[m].bent.data(),
                          first.meshes[m].bent.size() * sizeof(V3f)),
              0);
  }
}

TEST(Bake, DefaultsAreWithinThreeHundredthsOfExactWithManyRays) {
  const Scene tree = make_procedural("scene:tree?leaves=5000");
  BakeOptions exact = many_rays();
  exact.rays = 2048;
  const BakeResult found = bake(tree), truth = bake(tree, exact);
  double square = 0, sum = 0;
  std::size_t count = 0;
  for (std::size_t m = 0; m < found.meshes.size(); ++m) {
    for (std::size_t v = 0; v < found.meshes[m].ao.size(); ++v, ++count) {
      const double error = double{found.meshes[m].ao[v]} - truth.meshes[m].ao[v];
      square += error * error;
      sum += error;
    }
  }
  const auto n = static_cast<double>(count);
  std::printf("baked tree: RMSE %.4f, mean %+.4f\n", std::sqrt(square / n), sum / n);
  EXPECT_LT(std::sqrt(square / n), 0.03);
  EXPECT_LT(std::fabs(sum / n), 0.006);
  const BakeStatistics& s = found.statistics;
  const double estimated = std::sqrt(s.squared_errors / static_cast<double>(s.vertices));
  EXPECT_NEAR(estimated, std::sqrt(square / n), 0.008);
}

TEST(Bake, ASmallerTargetErrorTakesMoreRaysAndASmallerErrorIsLeft) {
  const Scene tree = make_procedural("scene:tree?leaves=500");
  const auto bake_to = [&](float target) {
    BakeOptions options;
    options.target_error = target;
    return bake(tree, options).statistics;
  };
  const BakeStatistics rough = bake_to(0.08f), fine = bake_to(0.02f);
  EXPECT_GT(fine.rays, 2 * rough.rays);
  EXPECT_LT(fine.squared_errors, rough.squared_errors / 4);
}

TEST(Bake, WithATargetRaysAreTheLimitOfATriangle) {
  const Scene tree = make_procedural("scene:tree?leaves=500");
  BakeOptions options;
  options.target_error = 1e-4f;
  options.rays = 64;
  const BakeStatistics s = bake(tree, options).statistics;
  EXPECT_LE(s.rays, s.triangles * 2 * 64);
  EXPECT_GT(s.rays, s.triangles * 32);
}

TEST(Bake, StopsWhenAskedAndRefusesValuesOutOfRange) {
  const Scene tree = make_procedural("scene:tree?leaves=2000");
  RenderControl control;
  control.stop = [] { return true; };
  EXPECT_TRUE(bake(tree, {}, control).interrupted);
  for (const int rays : {0, 7, 65537}) {
    BakeOptions options;
    options.rays = rays;
    EXPECT_THROW(bake(tree, options), Error) << rays;
  }
}

}  // namespace
}  // namespace dapple
