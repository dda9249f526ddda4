// Files that glTF does not allow, or that hardly mean what they say, and that are read all the
// same: each brings a note that names the file and the element. And legal ones that once were
// refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_note(const Scene& scene, const std::string& text) {
  ASSERT_EQ(scene.warnings.size(), 1u) << text;
  expect_says(scene.warnings[0], "scene.glb: " + text);
}

TEST(OddGltf, AByteOrderMarkIsNoted) {
  GltfBuilder builder = one_triangle();
  json document = builder.doc;
  const TempFolder folder;
  document["buffers"] = json::array({{{"byteLength", builder.bin.size()}, {"uri", "a.bin"}}});
  folder.write("a.bin", builder.bin);
  const Scene scene = load_gltf(folder.write("scene.glb", "\xef\xbb\xbf" + document.dump()));
  expect_note(scene, "its JSON begins with a byte order mark");
  EXPECT_EQ(world_triangles(scene).size(), 1u);
}

TEST(OddGltf, AMeshWithoutPrimitivesIsNoted) {
  GltfBuilder builder = one_triangle();
  builder.add("nodes",
              {{"mesh", builder.add("meshes", {{"name", "none"}, {"primitives", json::array()}})}});
  expect_note(builder.load(), "mesh 1 (\"none\") has no primitives, which glTF demands");
}

TEST(OddGltf, StripsOfTwoVerticesAreNoted) {
  GltfBuilder builder = one_triangle();
  for (int i = 0; i < 2; ++i)
    builder.add_mesh(
        {{"attributes", {{"POSITION", builder.add_positions({0, 0, 0, 1, 0, 0})}}}, {"mode", 5}});
  expect_note(builder.load(),
              "mesh 1 primitive 0 has too few vertices for a triangle or segment (2 of them)");
}

TEST(OddGltf, APositionWithoutAViewIsNoted) {
  GltfBuilder builder = one_triangle();
  const int zeros =
      builder.add("accessors", {{"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  builder.add_mesh({{"attributes", {{"POSITION", zeros}}}});
  expect_note(builder.load(), "mesh 1 primitive 0 has a POSITION without a bufferView");
}

/// A triangle whose blended texture has these coordinates and alphas.
GltfBuilder textured(const std::vector<float>& uvs, const std::vector<float>& colors,
                     const Bytes& png) {
  GltfBuilder builder;
  builder.add("images", {{"bufferView", builder.add_view(png)}, {"mimeType", "image/png"}});
  builder.add("textures", {{"source", 0}});
  builder.add("materials", {{"alphaMode", "BLEND"},
                            {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  builder.add_mesh({{"attributes",
                     {{"POSITION", builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0})},
                      {"TEXCOORD_0", builder.add_accessor(uvs, kFloat, "VEC2")},
                      {"COLOR_0", builder.add_accessor(colors, kFloat, "VEC4")}}},
                    {"material", 0}});
  return builder;
}

TEST(OddGltf, NumbersOfVerticesThatAreNotFiniteAreNoted) {
  const Bytes image = png::with_alpha(1, 1, {200});
  const std::vector<float> white{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  std::vector<float> odd = white;
  odd[3] = odd[11] = kNan;
  expect_note(textured({0, 0, kNan, 0, 0, 1}, white, image).load(),
              "mesh 0 primitive 0 has texture coordinates that are not finite");
  const Scene scene = textured({0, 0, 1, 0, 0, 1}, odd, image).load();
  expect_note(scene, "mesh 0 primitive 0 has vertex alphas that are NaN: they count as 0 (2 of");
  EXPECT_EQ(scene.meshes[0].vertex_alpha, (std::vector<float>{0, 1, 0}));
}

TEST(OddGltf, MorphTargetsOfColoursAndCoordinatesAreNotedWhereThoseAreRead) {
  const std::vector<float> uvs{0, 0, 1, 0, 0, 1}, white(12, 1.0f);
  for (const char* attribute : {"COLOR_0", "TEXCOORD_0", "TEXCOORD_1"}) {
    GltfBuilder builder = textured(uvs, white, png::with_alpha(1, 1, {200}));
    json& primitive = builder.doc["meshes"][0]["primitives"][0];
    const std::string base = attribute == std::string("COLOR_0") ? "COLOR_0" : "TEXCOORD_0";
    primitive["targets"] = {{{attribute, primitive["attributes"][base]}}};
    if (attribute == std::string("TEXCOORD_1"))
      EXPECT_TRUE(builder.load().warnings.empty());
    else
      expect_note(builder.load(), "mesh 0 primitive 0 has morph targets of colours or texture");
  }
}

/// A PNG of one row of indices with 4 bits each, and a palette of `colors`.
Bytes palette_png(const Bytes& packed, std::uint8_t colors) {
  Bytes file = png::encode(static_cast<std::uint32_t>(2 * packed.size()), 1, 4, 3, packed);
  Bytes chunk;
  png::append_chunk(chunk, "PLTE", Bytes(std::size_t{3} * colors, 9));
  png::append_chunk(chunk, "tRNS", Bytes(colors, 100));
  constexpr std::ptrdiff_t kAfterHeader = 8 + 12 + 13;
  file.insert(file.begin() + kAfterHeader, chunk.begin(), chunk.end());
  return file;
}

TEST(OddGltf, AColourThatThePaletteLacksIsRefused) {
  const std::vector<float> uvs{0, 0, 1, 0, 0, 1}, white(12, 1.0f);
  EXPECT_TRUE(textured(uvs, white, palette_png({0x01, 0x24}, 5)).load().warnings.empty());
  expect_says(error_of(textured(uvs, white, palette_png({0x01, 0x25}, 5))),
              "pixel 3, 0 has the colour 5 of a palette of 5");
}

TEST(OddGltf, AChainOfTenThousandNodesIsLegal) {
  GltfBuilder builder = one_triangle();
  for (int i = 1; i <= 10'000; ++i)
    builder.add("nodes", {{"children", {i - 1}}, {"translation", {0, 0, 1}}});
  builder.add("scenes", {{"nodes", {10'000}}});
  const Scene scene = builder.load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(world_triangles(scene)[0][0], V3f(0, 0, 10'000));
}

}  // namespace
}  // namespace dapple::test
