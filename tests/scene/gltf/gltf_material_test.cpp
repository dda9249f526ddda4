// The glTF reader's materials: opacity from factors, textures and vertex colours, emission, and
// which images the reader opens.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

/// A triangle with texture coordinates in sets 0 and 1, vertex colours with the alphas 0, 0.5
/// and 1, and the given material.
GltfBuilder textured_triangle(const json& material) {
  GltfBuilder builder;
  const int position = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int uv0 = builder.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, kFloat, "VEC2");
  const int uv1 =
      builder.add_accessor(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 0}, kUint16, "VEC2", true);
  const int color = builder.add_accessor(std::vector<float>{1, 1, 1, 0, 1, 1, 1, 0.5f, 1, 1, 1, 1},
                                         kFloat, "VEC4");
  builder.add_mesh(
      {{"attributes",
        {{"POSITION", position}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}, {"COLOR_0", color}}},
       {"material", 0}});
  builder.add("materials", material);
  return builder;
}

/// Adds an RGBA image of 2 x 2 texels to the binary chunk. The alphas of its rows are 10, 20 and
/// 30, 40.
void add_image(GltfBuilder& builder) {
  const int view = builder.add_view(png::with_alpha(2, 2, {10, 20, 30, 40}));
  const int image = builder.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", image}});
}

json blend_with_texture(int texture) {
  return {{"alphaMode", "BLEND"},
          {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}};
}

// Walls with such a texture are walls.
TEST(GltfMaterial, AnOpaqueAlphaTextureIsNone) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  const int view = builder.add_view(png::with_alpha(2, 2, {255, 255, 255, 255}));
  const int image = builder.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", image}});
  const Scene scene = builder.load();
  EXPECT_EQ(scene.materials.at(0).alpha_texture, -1);
  EXPECT_TRUE(scene.textures.empty());
}

// All have the texel at 0, 0, whether another primitive has texture coordinates or not.
TEST(GltfMaterial, VerticesWithoutTextureCoordinatesHaveZeros) {
  GltfBuilder builder;
  const int position = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"material", 0}});
  builder.add("materials", blend_with_texture(0));
  add_image(builder);
  const Scene scene = builder.load();
  EXPECT_EQ(scene.materials.at(0).alpha_texture, 0);
  EXPECT_EQ(scene.meshes.at(0).uvs, std::vector<V2f>(3, V2f(0, 0)));
}

TEST(GltfMaterial, ReadsModeFactorCutoffAndName) {
  const Scene scene =
      textured_triangle({{"name", "leaf"},
                         {"alphaMode", "MASK"},
                         {"alphaCutoff", 0.25},
                         {"doubleSided", true},
                         {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.75}}}}})
          .load();
  const Material& material = scene.materials.at(0);
  EXPECT_EQ(material.name, "leaf");
  EXPECT_EQ(material.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(material.alpha, 0.75f);
  EXPECT_EQ(material.alpha_cutoff, 0.25f);
  EXPECT_EQ(material.alpha_texture, -1);
  EXPECT_TRUE(material.double_sided);
}

TEST(GltfMaterial, WithoutANameIsNamedByItsNumber) {
  EXPECT_EQ(textured_triangle(json::object()).load().materials.at(0).name, "material_0");
}

TEST(GltfMaterial, VertexAlphaIsReadOnlyWhereItCounts) {
  GltfBuilder builder = textured_triangle({{"alphaMode", "BLEND"}});
  EXPECT_EQ(builder.load().meshes.at(0).vertex_alpha, (std::vector<float>{0, 0.5f, 1}));
  EXPECT_TRUE(builder.load().meshes.at(0).uvs.empty()) << "no texture looks them up";
  builder.doc["materials"][0]["alphaMode"] = "OPAQUE";
  EXPECT_TRUE(builder.load().meshes.at(0).vertex_alpha.empty());
}

TEST(GltfMaterial, VertexAlphaOfBytesIsAFraction) {
  GltfBuilder builder = textured_triangle({{"alphaMode", "BLEND"}});
  builder.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = builder.add_accessor(
      std::vector<std::uint8_t>{9, 9, 9, 255, 9, 9, 9, 51, 9, 9, 9, 0}, kUint8, "VEC4", true);
  EXPECT_EQ(builder.load().meshes.at(0).vertex_alpha, (std::vector<float>{1, 51 / 255.0f, 0}));
}

TEST(GltfMaterial, AnOpaqueOneOpensNoImage) {
  GltfBuilder builder =
      textured_triangle({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder.add("images", {{"uri", "absent.png"}});
  builder.add("textures", {{"source", 0}});
  const Scene scene = builder.load();
  EXPECT_EQ(scene.materials.at(0).alpha_texture, -1);
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfMaterial, AnUnusedOneOpensNoImage) {
  GltfBuilder builder = textured_triangle(json::object());
  builder.add("materials", blend_with_texture(0));
  builder.add("images", {{"uri", "absent.png"}});
  builder.add("textures", {{"source", 0}});
  EXPECT_TRUE(builder.load().textures.empty());
}

TEST(GltfMaterial, ABlendedOneHasTheAlphaOfItsTextureAndItsCoordinates) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  add_image(builder);
  builder.doc["textures"][0]["sampler"] = 0;
  builder.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  const Scene scene = builder.load();
  ASSERT_EQ(scene.materials.at(0).alpha_texture, 0);
  const Texture& texture = scene.textures.at(0);
  EXPECT_EQ(texture.width, 2u);
  EXPECT_EQ(texture.height, 2u);
  EXPECT_EQ(texture.alpha, (Bytes{10, 20, 30, 40}));
  EXPECT_EQ(texture.wrap_s, Wrap::clamp);
  EXPECT_EQ(texture.wrap_t, Wrap::mirror);
  EXPECT_TRUE(texture.nearest);
  EXPECT_EQ(scene.meshes.at(0).uvs, (std::vector<V2f>{{0, 0}, {1, 0}, {0, 1}}));
}

TEST(GltfMaterial, ImagesOfOneSamplerAreShared) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  add_image(builder);
  builder.add("textures", {{"source", 0}});
  builder.add("textures", {{"source", 0}, {"sampler", 0}});
  builder.add("samplers", {{"wrapS", 33071}});
  for (const int texture : {1, 2}) {
    const int material = builder.add("materials", blend_with_texture(texture));
    json primitive = builder.doc["meshes"][0]["primitives"][0];
    primitive["material"] = material;
    builder.doc["meshes"][0]["primitives"].push_back(primitive);
  }
  const Scene scene = builder.load();
  EXPECT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.materials[0].alpha_texture, scene.materials[1].alpha_texture);
  EXPECT_NE(scene.materials[0].alpha_texture, scene.materials[2].alpha_texture);
}

TEST(GltfMaterial, TheTextureChoosesItsCoordinateSet) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  add_image(builder);
  auto& info = builder.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  info["texCoord"] = 1;
  const std::vector<V2f> second = {{0, 0}, {1, 0}, {0, 0}};
  EXPECT_EQ(builder.load().meshes.at(0).uvs, second);
  info["texCoord"] = 0;
  info["extensions"]["KHR_texture_transform"]["texCoord"] = 1;
  EXPECT_EQ(builder.load().meshes.at(0).uvs, second) << "the extension overrides it";
}

TEST(GltfMaterial, TheTextureTransformIsBakedIntoTheCoordinates) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  add_image(builder);
  // The example in the extension's text: the lower left quadrant of the image, with u in [0, 0.5]
  // and v in [0.5, 1].
  builder.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
      {"KHR_texture_transform",
       {{"offset", {0, 1}}, {"rotation", std::numbers::pi / 2}, {"scale", {0.5, 0.5}}}}};
  const auto uvs = builder.load().meshes.at(0).uvs;
  const std::vector<V2f> expected = {{0, 1}, {0, 0.5f}, {0.5f, 1}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE((uvs.at(i) - expected[i]).length(), 1e-6f) << uvs[i];
  }
}

TEST(GltfMaterial, SpecularGlossinessBringsItsOwnAlpha) {
  GltfBuilder builder = textured_triangle(
      {{"alphaMode", "BLEND"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.1}}}},
       {"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {1, 1, 1, 0.5}}, {"diffuseTexture", {{"index", 0}}}}}}}});
  add_image(builder);
  const Scene scene = builder.load();
  EXPECT_EQ(scene.materials.at(0).alpha, 0.5f);
  EXPECT_EQ(scene.materials.at(0).alpha_texture, 0);
  EXPECT_EQ(scene.meshes.at(0).uvs.size(), 3u);
}

TEST(GltfMaterial, ImagesWithoutAnAlphaChannelAreOpaque) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  const int view = builder.add_view(png::encode(2, 1, 8, 2, {1, 2, 3, 4, 5, 6}));
  builder.add("images", {{"bufferView", view}});
  builder.add("textures", {{"source", 0}});
  EXPECT_EQ(builder.load().materials.at(0).alpha_texture, -1);
}

TEST(GltfMaterial, SixteenBitAlphaKeepsItsHighByte) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  const int view = builder.add_view(png::encode(2, 1, 16, 4, {0, 0, 0x80, 0x01, 0, 0, 0xff, 0xff}));
  builder.add("images", {{"bufferView", view}});
  builder.add("textures", {{"source", 0}});
  EXPECT_EQ(builder.load().textures.at(0).alpha, (Bytes{0x80, 0xff}));
}

TEST(GltfMaterial, ExternalAndDataUrisAreRead) {
  GltfBuilder builder = textured_triangle(blend_with_texture(0));
  builder.add("images", {{"uri", "tex%20tures/leaf%23.png"}});
  builder.add("textures", {{"source", 0}});
  builder.doc["buffers"] = {{{"uri", "scene.bin"}, {"byteLength", builder.bin.size()}}};
  const TempFolder folder;
  folder.write("scene.bin", builder.bin);
  folder.write("tex tures/leaf#.png", png::with_alpha(1, 1, {77}));
  const Scene scene = load_gltf(folder.write("scene.gltf", builder.doc.dump()));
  EXPECT_EQ(world_triangles(scene).size(), 1u);
  EXPECT_EQ(scene.textures.at(0).alpha, (Bytes{77}));
  EXPECT_EQ(scene.textures.at(0).name, "tex%20tures/leaf%23.png");
}

TEST(GltfMaterial, ADataUriHoldsABuffer) {
  GltfBuilder builder;
  // Three vertices (0,0,0) (1,0,0) (0,1,0): 36 bytes are 48 base64 digits.
  builder.doc["buffers"] = {{{"uri",
                              "data:application/octet-stream;base64,"
                              "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"},
                             {"byteLength", 36}}};
  builder.doc["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
  builder.add("accessors",
              {{"bufferView", 0}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  builder.add_mesh({{"attributes", {{"POSITION", 0}}}});
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", builder.doc.dump()));
  EXPECT_EQ(world_triangles(scene),
            (std::vector<Triangle>{{V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0)}}));
}

TEST(GltfMaterial, EmittingPrimitivesBecomeMeshesAndLightsOfTheirOwn) {
  GltfBuilder builder = textured_triangle(json::object());
  builder.add("materials",
              {{"name", "glow"},
               {"doubleSided", true},
               {"emissiveFactor", {1, 0.5, 0}},
               {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}});
  json primitive = builder.doc["meshes"][0]["primitives"][0];
  primitive["material"] = 1;
  builder.doc["meshes"][0]["primitives"].push_back(primitive);
  builder.add("nodes", {{"mesh", 0}, {"name", "lamp"}, {"translation", {2, 0, 0}}});
  const Scene scene = builder.load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  ASSERT_EQ(scene.instances.size(), 4u);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.instances[0].light, -1);
  EXPECT_EQ(scene.instances[1].light, 0);
  EXPECT_EQ(scene.instances[3].light, 1);
  EXPECT_EQ(scene.lights[0].name, "glow");
  EXPECT_EQ(scene.lights[1].name, "lamp");
  EXPECT_EQ(scene.lights[1].kind, LightKind::mesh);
  EXPECT_EQ(scene.lights[1].radiance, V3f(4, 2, 0));
  EXPECT_TRUE(scene.lights[1].double_sided);
}

TEST(GltfMaterial, AnEmissiveTextureCountsByItsLinearMean) {
  GltfBuilder builder =
      textured_triangle({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  const int view = builder.add_view(png::encode(2, 1, 8, 2, {255, 255, 0, 0, 255, 0}));
  builder.add("images", {{"bufferView", view}});
  builder.add("textures", {{"source", 0}});
  EXPECT_EQ(builder.load().lights.at(0).radiance, V3f(0.5f, 1, 0));
}

TEST(GltfMaterial, AMissingEmissiveTextureIsAWarning) {
  GltfBuilder builder =
      textured_triangle({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  builder.add("images", {{"uri", "absent.png"}});
  builder.add("textures", {{"source", 0}});
  const Scene scene = builder.load();
  EXPECT_EQ(scene.lights.at(0).radiance, V3f(1, 1, 1));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("absent.png"), std::string::npos);
}

}  // namespace
}  // namespace dapple::test
