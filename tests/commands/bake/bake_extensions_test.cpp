// dapple bake of files with extensions that say again what a bake changes: compressed copies of
// attributes, other materials of a primitive, images of other formats.
#include <gtest/gtest.h>

#include "dapple/scene.hpp"
#include "support/files/draco_gltf.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

using test::kDraco;
constexpr const char* kVariants = "KHR_materials_variants";

class BakeExtensions : public BakeCommand {
 protected:
  [[nodiscard]] json baked(const std::string& arguments) const {
    const Outcome run = dapple("bake in.glb -o out.glb " + arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.code == 0 ? document("out.glb") : json();
  }
  /// The occlusion texture of a material of the first primitive, an index of the document.
  static json occlusion_of(const json& doc, const json& material) {
    return doc["materials"][material.get<std::size_t>()].value("occlusionTexture", json());
  }
};

GltfBuilder compressed_triangle(const test::DracoOptions& options = {}) {
  GltfBuilder builder = rich_triangle();
  json& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = builder.add_accessor(
      test::Bytes{9, 8, 7, 255, 99, 9, 7, 255, 1, 2, 3, 255}, test::kUint8, "VEC4", true);
  attributes["NORMAL"] = builder.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  return draco_compressed(builder, options);
}

TEST_F(BakeExtensions, CompressedPrimitivesStayCompressedBesideWhatIsBaked) {
  write("in.glb", compressed_triangle().glb());
  const json before = document("in.glb")["meshes"][0]["primitives"][0];
  for (const char* output : {"out.glb", "out.gltf"}) {
    const Outcome run = dapple(std::string("bake in.glb --channel _AO -o ") + output);
    EXPECT_EQ(run.code, 0) << run.err;
    const json after = document(output);
    const json& primitive = after["meshes"][0]["primitives"][0];
    EXPECT_EQ(primitive["extensions"][kDraco]["attributes"],
              before["extensions"][kDraco]["attributes"]);
    EXPECT_EQ(after["extensionsUsed"], document("in.glb")["extensionsUsed"]);
    const std::size_t ao = primitive["attributes"]["_AO"];
    EXPECT_TRUE(after["accessors"][ao].contains("bufferView")) << output;
    EXPECT_EQ(after["accessors"][ao]["count"], 3);
  }
  EXPECT_EQ(baked("--to instance")["meshes"], document("in.glb")["meshes"]);
}

TEST_F(BakeExtensions, WhatABakeReplacesIsCompressedNoLonger) {
  for (const bool with_fallback : {false, true}) {
    write("in.glb", compressed_triangle({.with_fallback = with_fallback}).glb());
    const std::map<std::string, std::string> cases = {
        {"", "COLOR_0"}, {"--channel _AO --passes ao,bent --bent-channel NORMAL", "NORMAL"}};
    for (const auto& [arguments, name] : cases) {
      const json after = baked(arguments);
      const json& primitive = after["meshes"][0]["primitives"][0];
      json left = document("in.glb")["meshes"][0]["primitives"][0]["extensions"][kDraco];
      left["attributes"].erase(name);
      EXPECT_EQ(primitive["extensions"][kDraco]["attributes"], left["attributes"]) << name;
      const std::size_t replaced = primitive["attributes"][name];
      EXPECT_TRUE(after["accessors"][replaced].contains("bufferView")) << name;
    }
  }
}

// The extension's schema wants one attribute.
TEST_F(BakeExtensions, APrimitiveWhoseOnlyCompressedAttributeIsReplacedIsPlain) {
  const GltfBuilder in =
      compressed_triangle({.method = draco::MESH_SEQUENTIAL_ENCODING,
                           .left_plain = {"POSITION", "NORMAL", "_TEMPERATURE"}});
  write("in.glb", in.glb());
  const json after = baked("");
  EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(after["extensionsUsed"], json{"ACME_wind"});
  EXPECT_FALSE(after.contains("extensionsRequired"));
  EXPECT_EQ(test::world_triangles(load_gltf(path("out.glb"))), test::world_triangles(in.load()));
}

TEST_F(BakeExtensions, PrimitivesWithNewVerticesAreCompressedNoLonger) {
  write("in.glb", compressed_triangle().glb());
  const json after = baked("--to texture --size 16");
  EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(after["extensionsUsed"], json{"ACME_wind"});
  EXPECT_FALSE(after.contains("extensionsRequired"));
}

TEST_F(BakeExtensions, CompressedMeshesThatAreNotBakedStayAsTheyAre) {
  GltfBuilder builder = compressed_triangle();
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);  // no node shows it
  write("in.glb", builder.glb());
  const json after = baked("--to texture --size 16");
  EXPECT_FALSE(after["meshes"][0]["primitives"][0].contains("extensions"));
  EXPECT_EQ(after["meshes"][1]["primitives"][0]["extensions"][kDraco]["attributes"],
            builder.doc["meshes"][1]["primitives"][0]["extensions"][kDraco]["attributes"]);
  EXPECT_EQ(after["extensionsUsed"], builder.doc["extensionsUsed"]);
}

GltfBuilder triangle_with_variants() {
  GltfBuilder builder = rich_triangle();
  builder.doc["materials"] = {{{"name", "summer"}}, {{"name", "autumn"}}};
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["extensions"][kVariants]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                    {{"material", 0}, {"variants", {1}}}};
  builder.doc["extensions"][kVariants]["variants"] = {{{"name", "autumn"}}, {{"name", "summer"}}};
  builder.doc["extensionsUsed"].push_back(kVariants);
  return builder;
}

TEST_F(BakeExtensions, MaterialsOfAllVariantsGetTheTexture) {
  write("in.glb", triangle_with_variants().glb());
  const json after = baked("--to texture --size 16");
  EXPECT_EQ(after["materials"].size(), 2u);
  for (int material : {0, 1}) EXPECT_EQ(occlusion_of(after, material)["index"], 0);
  EXPECT_EQ(after["meshes"][0]["primitives"][0]["extensions"],
            document("in.glb")["meshes"][0]["primitives"][0]["extensions"]);
}

TEST_F(BakeExtensions, VariantsNameTheCopiesOfMaterialsThatOtherMeshesUse) {
  GltfBuilder builder = triangle_with_variants();
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);  // no node shows it
  write("in.glb", builder.glb());
  const json after = baked("--to texture --size 16");
  ASSERT_EQ(after["materials"].size(), 4u);
  for (int material : {0, 1}) EXPECT_TRUE(occlusion_of(after, material).is_null());
  const json& primitive = after["meshes"][0]["primitives"][0];
  const json& mappings = primitive["extensions"][kVariants]["mappings"];
  EXPECT_EQ(mappings[1]["material"], primitive["material"]) << "summer is the default";
  EXPECT_NE(mappings[0]["material"], primitive["material"]);
  for (const json& mapping : mappings)
    EXPECT_EQ(occlusion_of(after, mapping["material"])["index"], 0);
  EXPECT_EQ(after["meshes"][1], builder.doc["meshes"][1]);
}

// JSON makes no difference between 1.0 and 1.
// Else the bake would take the morph target's numbers for unused ones.
TEST_F(BakeExtensions, MorphTargetsMayWriteTheirAccessorsWithAPoint) {
  GltfBuilder builder = rich_triangle();
  const int offsets =
      builder.add_accessor(std::vector<float>{0, 1, 0, 0, 2, 0, 0, 3, 0}, test::kFloat, "VEC3");
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  primitive["attributes"]["COLOR_0"] = offsets;
  primitive["targets"] = {{{"POSITION", static_cast<double>(offsets)}}};
  write("in.glb", builder.glb());
  const json after = baked("--blend replace --rays 8");
  const test::GltfData file(path("out.glb"));
  EXPECT_EQ(file.floats(after["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]),
            (std::vector<float>{0, 1, 0, 0, 2, 0, 0, 3, 0}));
}

TEST_F(BakeExtensions, VariantsMayWriteTheirMaterialWithAPoint) {
  GltfBuilder builder = triangle_with_variants();
  json& mappings = builder.doc["meshes"][0]["primitives"][0]["extensions"][kVariants]["mappings"];
  mappings[0]["material"] = 1.0;
  write("in.glb", builder.glb());
  const json after = baked("--to texture --size 16");
  EXPECT_EQ(after["materials"].size(), 2u);
  for (int material : {0, 1}) EXPECT_EQ(occlusion_of(after, material)["index"], 0) << material;
}

TEST_F(BakeExtensions, EmbeddedImagesHaveTheirOwnMediaType) {
  GltfBuilder builder = rich_triangle();
  builder.doc["images"] = {{{"uri", "leaf.webp"}}};
  write("in.glb", builder.glb());
  write_bytes(path("leaf.webp"), "RIFF1234WEBPVP8L");
  EXPECT_EQ(baked("")["images"][0]["mimeType"], "image/webp");
}

// An occlusion texture with a transform is replaced by one without.
TEST_F(BakeExtensions, ExtensionsThatNoElementHasAnyMoreAreNotListed) {
  for (const bool another : {false, true}) {
    GltfBuilder builder = triangle_with_variants();
    const int image =
        builder.add("images", {{"bufferView", builder.add_view(test::png::with_alpha(1, 1, {255}))},
                               {"mimeType", "image/png"}});
    builder.add("textures", {{"source", image}});
    const json texture = {{"index", 0},
                          {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
    for (json& material : builder.doc["materials"]) material["occlusionTexture"] = texture;
    if (another) builder.doc["materials"][0]["emissiveTexture"] = texture;
    builder.doc["extensionsUsed"].push_back("KHR_texture_transform");
    write("in.glb", builder.glb());
    const json used = baked("--to texture --size 16")["extensionsUsed"];
    EXPECT_EQ(std::count(used.begin(), used.end(), "KHR_texture_transform"), another ? 1 : 0);
  }
}

TEST_F(BakeExtensions, TextureCoordinatesThatATextureUsesAreNotReplaced) {
  GltfBuilder builder = triangle_with_variants();
  const int uvs = builder.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, test::kFloat, "VEC2");
  json& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"] = uvs;
  const int image =
      builder.add("images", {{"bufferView", builder.add_view(test::png::with_alpha(1, 1, {255}))},
                             {"mimeType", "image/png"}});
  builder.add("textures", {{"source", image}});
  builder.doc["materials"][1]["extensions"]["KHR_materials_sheen"]["sheenColorTexture"] = {
      {"index", 0},
      {"texCoord", 1},
      {"extensions", {{"KHR_texture_transform", {{"texCoord", 0}}}}}};
  write("in.glb", builder.glb());
  for (const char* channel : {"TEXCOORD_0.y", "TEXCOORD_1.x"}) {
    const Outcome run = dapple(std::string("bake in.glb -o out.glb --channel ") + channel);
    expect_failure(run, 2, "sheenColorTexture of material 1 (\"autumn\")");
    EXPECT_EQ(files_in_folder(), 1u);
  }
  EXPECT_TRUE(baked("--channel TEXCOORD_2.x")["meshes"][0]["primitives"][0]["attributes"].contains(
      "TEXCOORD_2"));
  builder.doc["materials"][1]["extensions"].erase("KHR_materials_sheen");
  builder.doc["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"] = {
      {{"featureCount", 2}, {"texture", {{"index", 0}, {"texCoord", 1}}}}};
  write("in.glb", builder.glb());
  std::filesystem::remove(path("out.glb"));
  expect_failure(dapple("bake in.glb -o out.glb --channel TEXCOORD_1.x"), 2,
                 "texture of its own extensions");
}

TEST_F(BakeExtensions, TextureCoordinatesThatATextureNamesWithAPointAreNotReplaced) {
  GltfBuilder builder = triangle_with_variants();
  json& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"] =
      builder.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, test::kFloat, "VEC2");
  const int image =
      builder.add("images", {{"bufferView", builder.add_view(test::png::with_alpha(1, 1, {255}))},
                             {"mimeType", "image/png"}});
  builder.add("textures", {{"source", image}});
  builder.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0},
                                                                             {"texCoord", 1.0}};
  write("in.glb", builder.glb());
  expect_failure(dapple("bake in.glb -o out.glb --channel TEXCOORD_1.x"), 2,
                 "baseColorTexture of material 0 (\"summer\")");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(BakeCommand, UnlitMaterialsAreNotedWhereTheyGetATexture) {
  GltfBuilder builder = rich_triangle();
  builder.add("materials", {{"extensions", {{"KHR_materials_unlit", json::object()}}}});
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  builder.doc["extensionsUsed"].push_back("KHR_materials_unlit");
  write("in.glb", builder.glb());
  const std::string note = "1 primitive is of KHR_materials_unlit";
  EXPECT_TRUE(contains(dapple("bake in.glb -o out.glb --to texture --size 16 --rays 8").err, note));
  EXPECT_FALSE(contains(dapple("bake in.glb -o out.glb --rays 8").err, note));
}

}  // namespace
}  // namespace dapple
