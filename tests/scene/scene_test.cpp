// Operations on a scene between reading and rendering: its bounds, --opacity, --ground, and merging
// meshes into world space.
#include "dapple/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "dapple/bvh.hpp"
#include "dapple/error.hpp"
#include "scene/ground.hpp"

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Mesh triangle_mesh(const std::string& name, V3f a, V3f b, V3f c) {
  Mesh mesh;
  mesh.name = name;
  mesh.positions = {a, b, c};
  mesh.indices = {0, 1, 2};
  mesh.materials = {0};
  return mesh;
}

Mesh unit_triangle(const std::string& name = "triangle") {
  return triangle_mesh(name, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
}

// A mesh of 300 triangles. Meshes with several instances are merged only if they have at most 256.
Mesh large_mesh() {
  Mesh mesh = unit_triangle("large");
  for (std::uint32_t i = 1; i < 300; ++i) {
    mesh.positions.emplace_back(0.0f, 1.0f, static_cast<float>(i));
    mesh.indices.insert(mesh.indices.end(), {0, 1, i + 2});
    mesh.materials.push_back(0);
  }
  return mesh;
}

M44f translation(V3f by) {
  M44f matrix;
  matrix.setTranslation(by);
  return matrix;
}

M44f scaling(V3f by) {
  M44f matrix;
  matrix.setScale(by);
  return matrix;
}

Instance placed(std::uint32_t mesh, const M44f& to_world = M44f{}, int light = -1) {
  Instance instance;
  instance.mesh = mesh;
  instance.to_world = to_world;
  instance.light = light;
  return instance;
}

Scene scene_of(std::vector<Mesh> meshes, std::vector<Instance> instances) {
  Scene scene;
  scene.source = "test.glb";
  scene.materials.resize(2);
  scene.materials[0].name = "leaf";
  scene.materials[1].name = "bark";
  scene.meshes = std::move(meshes);
  scene.instances = std::move(instances);
  return scene;
}

using WorldTriangle = std::array<float, 10>;  // nine coordinates and a material

std::vector<WorldTriangle> world_triangles(const Scene& scene) {
  std::vector<WorldTriangle> triangles;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    // Where the matrix mirrors, corners change places: the front stays the front.
    const bool mirrored = Imath::M44d(instance.to_world).determinant() < 0;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      WorldTriangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t corner = mirrored && k > 0 ? 3 - k : k;
        const V3f p = mesh.positions[mesh.indices[3 * t + corner]] * instance.to_world;
        for (int axis = 0; axis < 3; ++axis)
          triangle[3 * k + static_cast<std::size_t>(axis)] = p[axis];
      }
      triangle[9] = static_cast<float>(mesh.materials[t]);
      triangles.push_back(triangle);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

template <typename Action>
std::string complaint(ErrorKind kind, Action action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "no error";
}

TEST(SceneBounds, HoldEveryPlacementInWorldSpace) {
  const Scene scene = scene_of({unit_triangle(), unit_triangle()},
                               {placed(0, translation({5, 0, 0})), placed(0, scaling({1, -2, 1})),
                                placed(1, translation({0, 0, 7}))});
  EXPECT_EQ(scene_bounds(scene).min, V3f(0, -2, 0));
  EXPECT_EQ(scene_bounds(scene).max, V3f(6, 1, 7));
}

TEST(SceneBounds, IgnoreVerticesThatNoTriangleUses) {
  Mesh mesh = unit_triangle();
  mesh.positions.emplace_back(kInfinity, 0.0f, 100.0f);
  EXPECT_EQ(scene_bounds(scene_of({mesh}, {placed(0)})).max, V3f(1, 1, 0));
}

TEST(SceneBounds, IgnoreVerticesAtInfinity) {
  Mesh mesh = unit_triangle();
  mesh.positions[0] = V3f(-kInfinity, -5.0f, 3.0f);  // the bounds leave out its triangle
  const Box3f bounds = scene_bounds(scene_of({mesh}, {placed(0, translation({5, 0, 0}))}));
  EXPECT_EQ(bounds.min, V3f(5, 0, 0));
  EXPECT_EQ(bounds.max, V3f(6, 1, 0));
}

TEST(SceneBounds, OfAnEmptySceneAreEmpty) {
  EXPECT_TRUE(scene_bounds(Scene{}).isEmpty());
  EXPECT_TRUE(scene_bounds(scene_of({unit_triangle()}, {})).isEmpty());
}

TEST(OverrideOpacity, ReplacesTextureFactorModeAndVertexAlpha) {
  Scene scene = scene_of({}, {});
  scene.materials[0] = {"leaf", AlphaMode::mask, 0.5f, 0.5f, 3, true, {0, 0, 0}, false};
  override_opacity(scene, "leaf", 0.85f);
  const Material& leaf = scene.materials[0];
  EXPECT_EQ(leaf.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(leaf.alpha, 0.85f);
  EXPECT_EQ(leaf.alpha_texture, -1);
  EXPECT_FALSE(leaf.uses_vertex_alpha);
  EXPECT_EQ(scene.materials[1].alpha_mode, AlphaMode::opaque);
}

TEST(OverrideOpacity, AnUnknownMaterialIsRefusedWithTheKnownOnes) {
  Scene scene = scene_of({}, {});
  EXPECT_EQ(complaint(ErrorKind::usage, [&] { override_opacity(scene, "leef", 1); }),
            "test.glb: there is no material \"leef\"; there are: \"leaf\", \"bark\"");
  EXPECT_EQ(complaint(ErrorKind::usage, [&] { override_opacity(scene, "leaf", 1.5f); }),
            "opacity of material \"leaf\" is 1.5, outside [0, 1]");
  EXPECT_EQ(complaint(ErrorKind::usage, [&] { override_opacity(scene, "leaf", std::nanf("")); }),
            "opacity of material \"leaf\" is nan, outside [0, 1]");
}

TEST(AddGround, IsOpaqueTwoHundredTimesAsWideAndJustBelowTheLowestPoint) {
  Scene scene = scene_of({triangle_mesh("a", {1, 2, 3}, {3, 5, 3}, {1, 4, 4})}, {placed(0)});
  add_ground(scene);
  const Box3f bounds = scene_bounds(scene);
  EXPECT_FLOAT_EQ(bounds.min.y, 2 - 3e-5f);
  EXPECT_EQ(bounds.max.y, 5);
  EXPECT_FLOAT_EQ(bounds.size().x, 400);
  EXPECT_FLOAT_EQ(bounds.size().z, 400);
  EXPECT_FLOAT_EQ(bounds.center().x, 2);
  EXPECT_FLOAT_EQ(bounds.center().z, 3.5f);
  EXPECT_EQ(scene.materials.back().name, "ground");
  EXPECT_EQ(scene.materials.back().alpha_mode, AlphaMode::opaque);
}

TEST(AddGround, IsAtTheHeightThatIsGivenAndAsWideAsEver) {
  for (const float height : {-7.0f, 0.0f, 4.0f}) {
    Scene scene = scene_of({triangle_mesh("a", {1, 2, 3}, {3, 5, 3}, {1, 4, 4})}, {placed(0)});
    add_ground(scene, scene_bounds(scene), height);
    EXPECT_EQ(scene.instances.back().to_world[3][1], height);
    EXPECT_FLOAT_EQ(scene_bounds(scene).size().x, 400);
  }
}

TEST(AddGround, IsBelowTheLowestVertexOfTiltedInstancesNotBelowTheirBoxes) {
  const Mesh mesh = triangle_mesh("a", {-1, 0, -1}, {1, 0, 1}, {0, 2, 0});
  const M44f tilted = M44f().setEulerAngles(V3f(0, 0, 0.4f)),
             aside = tilted * translation({9, 0.1f, 0});
  Scene shared = scene_of({mesh}, {placed(0, tilted), placed(0, aside)});
  Scene apart = scene_of({mesh, mesh}, {placed(0, tilted), placed(1, aside)});
  add_ground(shared);
  add_ground(apart);
  const float height = apart.instances.back().to_world[3][1];
  EXPECT_NEAR(shared.instances.back().to_world[3][1], height, 1e-4f);
  EXPECT_LT(scene_bounds(shared).min.y, -0.3f) << "the box reaches further";
}

TEST(Merge, KeepsEveryWorldSpaceTriangleWithItsFrontAndMakesOneMesh) {
  Scene scene = scene_of(
      {unit_triangle("a"), triangle_mesh("b", {1, 1, 1}, {2, 3, 4}, {0, 5, 1}), unit_triangle("c")},
      {placed(0, translation({3, 0, 0})), placed(1, scaling({-1, 1, 2})),
       placed(2, translation({0, 8, 0})), placed(2, scaling({2, 2, 2}))});
  scene.meshes[1].materials = {1};
  const auto before = world_triangles(scene);
  merge_single_instances(scene);
  EXPECT_EQ(world_triangles(scene), before);
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.instances[0].to_world, M44f{});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Merge, ALargeMeshThatIsPlacedOftenStaysAnInstance) {
  Scene scene = scene_of({large_mesh(), unit_triangle(), large_mesh()},
                         {placed(0), placed(0, translation({9, 0, 0})), placed(1), placed(2)});
  const auto before = world_triangles(scene);
  merge_single_instances(scene);
  EXPECT_EQ(world_triangles(scene), before);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.instances.size(), 3u);
  const auto large =
      std::count_if(scene.instances.begin(), scene.instances.end(),
                    [&](const auto& i) { return scene.meshes[i.mesh].name == "large"; });
  EXPECT_EQ(large, 2);
}

TEST(Merge, AMeshWithASingleIdentityInstanceIsNotCopied) {
  Scene scene = scene_of({large_mesh()}, {placed(0)});
  const V3f* const positions = scene.meshes[0].positions.data();
  const std::uint32_t* const indices = scene.meshes[0].indices.data();
  merge_single_instances(scene);
  EXPECT_EQ(scene.meshes.at(0).positions.data(), positions);
  EXPECT_EQ(scene.meshes[0].indices.data(), indices);
  EXPECT_EQ(scene.meshes[0].name, "large");
}

TEST(Merge, VertexAttributesThatOnlySomeMeshesHaveAreFilledWithDefaults) {
  Scene scene = scene_of({unit_triangle(), unit_triangle(), unit_triangle()},
                         {placed(0), placed(1), placed(2)});
  scene.meshes[1].uvs = {{1, 2}, {3, 4}, {5, 6}};
  scene.meshes[2].vertex_alpha = {0.1f, 0.2f, 0.3f};
  merge_single_instances(scene);
  const Mesh& mesh = scene.meshes.at(0);
  const V2f none(0, 0);
  EXPECT_EQ(mesh.uvs,
            (std::vector<V2f>{none, none, none, {1, 2}, {3, 4}, {5, 6}, none, none, none}));
  EXPECT_EQ(mesh.vertex_alpha, (std::vector<float>{1, 1, 1, 1, 1, 1, 0.1f, 0.2f, 0.3f}));
}

TEST(Merge, AMeshLightStaysOnItsOwnAndItsMeshMayBeUsedElsewhere) {
  Scene scene = scene_of({unit_triangle(), unit_triangle()},
                         {placed(0, translation({0, 9, 0}), 0), placed(0), placed(1)});
  scene.lights.resize(1);
  scene.lights[0].kind = LightKind::mesh;
  const auto before = world_triangles(scene);
  merge_single_instances(scene);
  EXPECT_EQ(world_triangles(scene), before);
  ASSERT_EQ(scene.instances.size(), 2u);
  const auto light = std::find_if(scene.instances.begin(), scene.instances.end(),
                                  [](const Instance& i) { return i.light == 0; });
  ASSERT_NE(light, scene.instances.end());
  EXPECT_EQ(light->to_world, translation({0, 9, 0}));
  EXPECT_EQ(scene.meshes[light->mesh].primitive_count(), 1u);
}

TEST(Merge, BrokenTrianglesAreDroppedAndCountedByKind) {
  Mesh mesh = unit_triangle();
  mesh.positions.insert(mesh.positions.end(),
                        {{kInfinity, 0, 0}, {0, std::nanf(""), 0}, {2, 0, 0}});
  mesh.indices = {0, 1, 3, 0, 1, 2, 4, 1, 2, 3, 4, 0, 0, 1, 5, 2, 2, 1};
  mesh.materials = {0, 1, 0, 0, 0, 0};
  mesh.vertex_alpha = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f};
  Scene scene = scene_of({mesh}, {placed(0, translation({1, 0, 0}))});
  merge_single_instances(scene);
  const Mesh& merged = scene.meshes.at(0);
  EXPECT_EQ(merged.positions, (std::vector<V3f>{{1, 0, 0}, {2, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(merged.indices, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(merged.materials, std::vector<std::uint32_t>{1});
  EXPECT_EQ(merged.vertex_alpha, (std::vector<float>{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(scene.warnings,
            (std::vector<std::string>{"dropped 3 triangles with non-finite vertices",
                                      "dropped 2 triangles without an area"}));
}

TEST(Merge, UnusedMeshesAndSingularInstancesAreDropped) {
  Scene scene =
      scene_of({unit_triangle("unplaced"), large_mesh(), unit_triangle()},
               {placed(1), placed(1, translation({2, 0, 0})), placed(2, scaling({1, 0, 1})),
                placed(1, translation({kInfinity, 0, 0}))});
  merge_single_instances(scene);
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "large");
  EXPECT_EQ(scene.instances.size(), 2u);
  for (const Instance& instance : scene.instances) EXPECT_EQ(instance.mesh, 0u);
  EXPECT_EQ(scene.warnings,
            std::vector<std::string>{"dropped 2 instances whose matrix cannot be inverted"});
}

TEST(Merge, AMeshLightWithoutATriangleIsDroppedOrDarkAndTheOthersKeepTheirInstances) {
  Scene scene = scene_of({unit_triangle(), unit_triangle()},
                         {placed(0, scaling({0, 0, 0}), 1), placed(1, M44f{}, 2)});
  scene.lights.resize(3);
  scene.lights[1].kind = scene.lights[2].kind = LightKind::mesh;
  scene.lights[1].name = "dark";
  scene.lights[2].name = "lamp";
  Scene moving = scene;
  moving.animations.resize(1);
  merge_single_instances(scene);
  ASSERT_EQ(scene.lights.size(), 2u);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_EQ(scene.lights.at(static_cast<std::size_t>(scene.instances[0].light)).name, "lamp");
  EXPECT_EQ(scene.warnings.back(), "dropped light \"dark\", which has no triangle");
  merge_single_instances(moving);
  ASSERT_EQ(moving.lights.size(), 3u);
  EXPECT_EQ(moving.lights.at(static_cast<std::size_t>(moving.instances.at(0).light)).name, "lamp");
  EXPECT_EQ(moving.warnings.back(), "light \"dark\" is dark: it has no triangle");
}

TEST(Merge, ASceneOfWhichNothingIsLeftIsRefused) {
  Scene scene = scene_of({triangle_mesh("line", {0, 0, 0}, {1, 1, 1}, {2, 2, 2})}, {placed(0)});
  EXPECT_EQ(complaint(ErrorKind::input, [&] { merge_single_instances(scene); }),
            "test.glb: there is nothing to render: no triangle or strand is left (dropped 1 "
            "triangle without "
            "an area)");
}

TEST(Merge, ASceneWithoutANameIsTheSceneInMessages) {
  Scene empty;
  EXPECT_TRUE(complaint(ErrorKind::input, [&] {
                merge_single_instances(empty);
              }).starts_with("the scene: there is nothing to render"));
  EXPECT_TRUE(complaint(ErrorKind::input, [&] {
                build_bvh(empty);
              }).starts_with("the scene: nothing to hit"));
  EXPECT_EQ(complaint(ErrorKind::input, [] { load_scene(""); }), "the path of the scene is empty");
}

TEST(Merge, AProceduralForestKeepsItsTriangles) {
  Scene scene = make_procedural("scene:forest?trees=60&leaves=30");
  const auto before = world_triangles(scene);
  merge_single_instances(scene);
  EXPECT_EQ(world_triangles(scene), before);
  EXPECT_EQ(scene.instances.size(), 61u);
}

}  // namespace
}  // namespace dapple
