// Colours of glTF files: factors, textures and COLOR_0, read only if they are requested.
#include <gtest/gtest.h>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

SceneOptions with_colors() {
  SceneOptions options;
  options.colors = true;
  return options;
}

/// One triangle of a material with this base colour, and an image of one texel if it is not empty.
GltfBuilder colored(const json& factor, const Bytes& image = {}) {
  GltfBuilder b = one_triangle();
  auto& primitive = b.doc["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_0"] = b.add_accessor<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2");
  json material = {{"pbrMetallicRoughness", {{"baseColorFactor", factor}}}};
  if (!image.empty()) {
    b.add("images", {{"bufferView", b.add_view(image)}, {"mimeType", "image/png"}});
    b.add("textures", {{"source", 0}});
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  }
  b.add("materials", material);
  return b;
}

Bytes one_texel() { return png::encode(1, 1, 8, 6, {10, 20, 30, 40}); }

TEST(GltfColors, FactorsAreAlwaysReadAndTexturesOnDemand) {
  const GltfBuilder b = colored({0.25, 0.5, 0.75, 1}, one_texel());
  const Scene without = b.load();
  EXPECT_EQ(without.materials.at(0).color, V3f(0.25f, 0.5f, 0.75f));
  EXPECT_EQ(without.materials[0].color_texture, -1);
  EXPECT_TRUE(without.color_textures.empty());
  EXPECT_TRUE(without.meshes.at(0).uvs.empty());
  const Scene with = b.load(with_colors());
  ASSERT_EQ(with.materials.at(0).color_texture, 0);
  const ColorTexture& texture = with.color_textures.at(0);
  EXPECT_EQ(texture.rgb, (std::vector<std::uint8_t>{10, 20, 30}));
  EXPECT_EQ(texture.alpha, (std::vector<std::uint8_t>{40}));
  EXPECT_EQ(with.meshes.at(0).uvs.size(), 3u);
  EXPECT_EQ(with.materials[0].alpha_texture, -1) << "an opaque material has no alpha texture";
}

TEST(GltfColors, AnImageServesAlphaAndColour) {
  GltfBuilder b = colored({1, 1, 1, 1}, one_texel());
  b.doc["materials"][0]["alphaMode"] = "BLEND";
  const Scene scene = b.load(with_colors());
  EXPECT_EQ(scene.textures.at(0).alpha, (std::vector<std::uint8_t>{40}));
  EXPECT_EQ(scene.color_textures.at(0).rgb, (std::vector<std::uint8_t>{10, 20, 30}));
}

TEST(GltfColors, AnImageThatCannotBeReadLeavesTheFactorWithANote) {
  const GltfBuilder b = colored({0.5, 0.5, 0.5, 1}, {1, 2, 3, 4});
  const Scene scene = b.load(with_colors());
  EXPECT_EQ(scene.materials.at(0).color_texture, -1);
  ASSERT_EQ(scene.warnings.size(), 1u);
  expect_says(scene.warnings[0], "its colour goes untextured");
}

// The image is read once; each material that has it says what is wrong.
TEST(GltfColors, AnImageThatCannotBeReadIsNamedByEachOfItsMaterials) {
  GltfBuilder b = colored({0.5, 0.5, 0.5, 1}, {1, 2, 3, 4});
  b.doc["materials"].push_back(b.doc["materials"][0]);
  b.doc["meshes"][0]["primitives"].push_back(b.doc["meshes"][0]["primitives"][0]);
  b.doc["meshes"][0]["primitives"][1]["material"] = 1;
  const Scene scene = b.load(with_colors());
  ASSERT_EQ(scene.warnings.size(), 2u);
  const std::string &first = scene.warnings[0], &second = scene.warnings[1];
  expect_says(first, "material 0");
  expect_says(second, "material 1");
  EXPECT_EQ(first.substr(first.rfind(": ")), second.substr(second.rfind(": ")));
  b.doc["materials"][1]["alphaMode"] = "MASK";
  const std::string refused = input_error([&] { static_cast<void>(b.load(with_colors())); });
  expect_says(refused, "material 1");
  expect_says(refused + "; its colour goes untextured", first.substr(first.rfind(": ")));
}

// Images are decoded several at a time, ahead of the materials that have them; some materials have
// the same image, with other wrap modes or without, and some images cannot be read.
TEST(GltfColors, EachMaterialHasItsImageHoweverManyAreDecodedAtATime) {
  constexpr int kImages = 40, kMaterials = 100;
  const auto is_broken = [](int image) { return image % 7 == 3; };
  GltfBuilder b = colored({1, 1, 1, 1}, one_texel());
  b.add("samplers", {{"wrapS", 33071}});
  for (int i = 1; i < kImages; ++i) {
    const auto code = static_cast<std::uint8_t>(i);
    const Bytes texel = png::encode(1, 1, 8, 6, {code, 20, 30, code});
    b.add("images", {{"bufferView", b.add_view(is_broken(i) ? Bytes{1, 2, 3} : texel)},
                     {"mimeType", "image/png"}});
    b.add("textures", {{"source", i}});
  }
  const auto image_of = [](int material) { return 1 + material * 17 % (kImages - 1); };
  const json first = b.doc["materials"][0], primitive = b.doc["meshes"][0]["primitives"][0];
  for (int m = 1; m < kMaterials; ++m) {
    json material = first, shown = primitive;
    int texture = image_of(m);
    if (m > kImages) {
      texture = static_cast<int>(b.doc["textures"].size());
      b.add("textures", {{"source", image_of(m)}, {"sampler", 0}});
    }
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", texture}};
    if (m % 2 == 0 && !is_broken(image_of(m))) material["alphaMode"] = "BLEND";
    b.add("materials", material);
    shown["material"] = m;
    if (m % 5 != 0) b.doc["meshes"][0]["primitives"].push_back(shown);  // others are not shown
  }
  const Scene scene = b.load(with_colors());
  std::size_t broken = 0;
  for (int m = 1; m < kMaterials; ++m) {
    const Material& material = scene.materials.at(static_cast<std::size_t>(m));
    const bool is_read = m % 5 != 0 && !is_broken(image_of(m));
    broken += m % 5 != 0 && is_broken(image_of(m)) ? 1 : 0;
    ASSERT_EQ(material.color_texture >= 0, is_read) << m;
    ASSERT_EQ(material.alpha_texture >= 0, is_read && m % 2 == 0) << m;
    if (!is_read) continue;
    const auto& color = scene.color_textures[static_cast<std::size_t>(material.color_texture)];
    EXPECT_EQ(color.rgb.at(0), image_of(m)) << m;
    EXPECT_EQ(color.wrap_s, m > kImages ? Wrap::clamp : Wrap::repeat) << m;
    if (m % 2 != 0) continue;
    const auto& alpha = scene.textures[static_cast<std::size_t>(material.alpha_texture)];
    EXPECT_EQ(alpha.alpha, std::vector<std::uint8_t>{color.rgb[0]}) << m;
  }
  EXPECT_EQ(scene.warnings.size(), broken);
}

TEST(GltfColors, APrimitiveWithoutTextureCoordinatesIsNamedInANote) {
  for (const char* mode : {"OPAQUE", "BLEND"}) {
    GltfBuilder b = colored({1, 1, 1, 1}, one_texel());
    b.doc["materials"][0]["alphaMode"] = mode;
    b.doc["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
    const Scene scene = b.load(with_colors());
    ASSERT_EQ(scene.warnings.size(), 1u) << mode;
    expect_says(scene.warnings[0], "mesh 0");
    expect_says(scene.warnings[0], "lacks the TEXCOORD of its base colour texture");
  }
  EXPECT_TRUE(colored({1, 1, 1, 1}).load(with_colors()).warnings.empty());
}

TEST(GltfColors, ColoursOfVerticesAreLinearWithAndWithoutAlpha) {
  GltfBuilder b = colored({1, 1, 1, 1});
  auto& attributes = b.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] =
      b.add_accessor<std::uint8_t>({255, 0, 51, 0, 0, 255, 0, 0, 0, 102, 0, 0}, 5121, "VEC4", true);
  const Scene scene = b.load(with_colors());
  EXPECT_EQ(scene.meshes.at(0).colors, (std::vector<V3f>{{1, 0, 0.2f}, {0, 1, 0}, {0, 0.4f, 0}}));
  EXPECT_TRUE(scene.meshes[0].vertex_alpha.empty()) << "an opaque material needs none";
  EXPECT_TRUE(b.load().meshes.at(0).colors.empty());
}

}  // namespace
}  // namespace dapple::test
