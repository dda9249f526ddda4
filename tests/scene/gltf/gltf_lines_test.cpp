// Lines in glTF files. Without --line-radius the reader leaves them out and says so; with it they
// become strands of that radius, with the opacity of their material, in a mesh apart from the
// triangles.
#include <gtest/gtest.h>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

constexpr int kLines = 1, kLoop = 2, kStrip = 3;
const std::vector<float> kPoints = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

using Ends = std::vector<std::uint32_t>;

SceneOptions with_radius(float radius) {
  SceneOptions options;
  options.line_radius = radius;
  return options;
}

GltfBuilder lines_of(int mode, const std::vector<float>& points = kPoints) {
  GltfBuilder builder;
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(points)}}}, {"mode", mode}});
  return builder;
}

Mesh only_mesh(const GltfBuilder& builder) {
  const Scene scene = builder.load(with_radius(0.5f));
  EXPECT_EQ(scene.meshes.size(), 1u);
  return scene.meshes.at(0);
}

TEST(GltfLines, EveryModeGivesTheSegmentsThatGltfSays) {
  EXPECT_EQ(only_mesh(lines_of(kLines)).indices, (Ends{0, 1, 2, 3}));
  EXPECT_EQ(only_mesh(lines_of(kStrip)).indices, (Ends{0, 1, 1, 2, 2, 3}));
  EXPECT_EQ(only_mesh(lines_of(kLoop)).indices, (Ends{0, 1, 1, 2, 2, 3, 3, 0}));
}

// As exporters write lines without indices. What meets in threes, or looks otherwise, has its end.
TEST(GltfLines, SegmentsWithVerticesOfTheirOwnAreJoined) {
  const std::vector<float> bend = {0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 1, 1, 0, 0, 1, 0};
  EXPECT_EQ(only_mesh(lines_of(kLines, bend)).indices, (Ends{0, 1, 1, 3, 3, 5}));
  const std::vector<float> star = {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1};
  EXPECT_EQ(only_mesh(lines_of(kLines, star)).indices, (Ends{0, 1, 2, 3, 4, 5}));
  GltfBuilder builder = lines_of(kLines, bend);
  builder.doc["materials"] = {{{"alphaMode", "BLEND"}}};
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["COLOR_0"] = builder.add_accessor(
      std::vector<float>{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, .5f, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
      kFloat, "VEC4");
  EXPECT_EQ(only_mesh(builder).indices, (Ends{0, 1, 2, 3, 3, 5}));
}

TEST(GltfLines, ALoopOfTwoPointsIsOneSegment) {
  EXPECT_EQ(only_mesh(lines_of(kLoop, {0, 0, 0, 1, 0, 0})).indices, (Ends{0, 1}));
}

TEST(GltfLines, AreStrandsOfTheGivenRadiusAndOfTheirMaterial) {
  const Mesh mesh = only_mesh(lines_of(kStrip));
  EXPECT_TRUE(mesh.has_strands());
  EXPECT_EQ(mesh.radii, std::vector<float>(4, 0.5f));
  EXPECT_EQ(mesh.materials, std::vector<std::uint32_t>(3, 0));
  EXPECT_TRUE(mesh.vertex_alpha.empty());
  EXPECT_EQ(mesh.positions[2], V3f(1, 1, 0));
}

TEST(GltfLines, TheRadiusIsInMetresWhateverTheScaleOfTheNode) {
  GltfBuilder builder = lines_of(kStrip);
  builder.doc["nodes"][0]["scale"] = {2, 2, 2};
  builder.add("nodes", {{"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}});
  const Scene scene = builder.load(with_radius(0.5f));
  ASSERT_EQ(scene.instances.size(), 2u);
  for (const Instance& instance : scene.instances) {
    const float scale = instance.to_world[0][0];
    EXPECT_FLOAT_EQ(scene.meshes[instance.mesh].radii[0] * scale, 0.5f);
  }
}

TEST(GltfLines, OfAMeshWithTrianglesAreAMeshBesideThem) {
  GltfBuilder builder;
  const int position = builder.add_positions(kPoints);
  builder.add("materials", {{"name", "wire"}});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
  builder.doc["meshes"][0]["name"] = "fence";
  builder.doc["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", position}}}, {"mode", kStrip}, {"material", 0}});
  builder.doc["nodes"][0]["translation"] = {0, 7, 0};
  const Scene scene = builder.load(with_radius(0.1f));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].name, "fence");
  EXPECT_FALSE(scene.meshes[0].has_strands());
  EXPECT_EQ(scene.meshes[0].primitive_count(), 2u);
  EXPECT_EQ(scene.meshes[1].name, "fence (lines)");
  EXPECT_TRUE(scene.meshes[1].has_strands());
  EXPECT_EQ(scene.meshes[1].primitive_count(), 3u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].to_world, scene.instances[1].to_world);
}

TEST(GltfLines, TakeFactorModeAndVertexAlphaOfTheirMaterialButNoTexture) {
  GltfBuilder builder;
  builder.add("images", {{"uri", "absent.png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials",
              {{"name", "web"},
               {"alphaMode", "BLEND"},
               {"pbrMetallicRoughness",
                {{"baseColorFactor", {1, 1, 1, 0.25}}, {"baseColorTexture", {{"index", 0}}}}}});
  const int colors = builder.add_accessor(
      std::vector<std::uint8_t>{0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 51, 0, 0, 0, 255}, kUint8,
      "VEC4", true);
  builder.add_mesh(
      {{"attributes", {{"POSITION", builder.add_positions(kPoints)}, {"COLOR_0", colors}}},
       {"mode", kStrip},
       {"material", 0}});
  const Scene scene = builder.load(with_radius(0.5f));
  EXPECT_EQ(scene.meshes[0].vertex_alpha, (std::vector<float>{1, 0, 0.2f, 1}));
  EXPECT_TRUE(scene.meshes[0].uvs.empty());
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::blend);
  EXPECT_EQ(scene.materials[0].alpha, 0.25f);
  EXPECT_EQ(scene.materials[0].alpha_texture, -1);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "line primitives have a texture, which is ignored");
}

TEST(GltfLines, ThatEmitAreNoLights) {
  GltfBuilder builder = lines_of(kStrip);
  builder.add("materials", {{"emissiveFactor", {1, 1, 1}}});
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  const Scene scene = builder.load(with_radius(0.5f));
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_EQ(scene.instances.at(0).light, -1);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "line primitives emit, which is ignored");
}

TEST(GltfLines, WithoutARadiusAreLeftOutAndTheFlagIsNamed) {
  GltfBuilder builder = lines_of(kStrip);
  expect_says(error_of(builder), "has no triangles; --line-radius R makes strands of its lines");
  builder.add_triangle();
  const Scene scene = builder.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "--line-radius R");
}

TEST(GltfLines, ThatAreMalformedAreRefusedByTheirPrimitive) {
  const auto refusal_of = [](const GltfBuilder& builder) {
    return input_error([&] { static_cast<void>(builder.load(with_radius(0.5f))); });
  };
  expect_says(refusal_of(lines_of(kLines, {0, 0, 0, 1, 0, 0, 1, 1, 0})),
              "mesh 0 primitive 0: 3 indices do not make whole segments");
  GltfBuilder far = lines_of(kStrip);
  far.doc["meshes"][0]["primitives"][0]["indices"] =
      far.add_accessor(std::vector<std::uint16_t>{0, 4}, kUint16, "SCALAR");
  expect_says(refusal_of(far), "mesh 0 primitive 0: index 1 names vertex 4, but there are 4");
}

TEST(GltfLines, ARadiusOutOfRangeIsRefusedByItsFlag) {
  for (const float radius : {-1.0f, 1e-9f, 1e9f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THROW(validate(with_radius(radius)), Error) << radius;
  }
}

}  // namespace
}  // namespace dapple::test
