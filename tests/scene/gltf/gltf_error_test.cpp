// Files that the glTF reader refuses. Each of them gives an Error of kind input, whose message is
// one line and names the file, the element and the wrong values.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

TEST(GltfError, MissingFilesFoldersAndFifosAreRefusedWithoutWaiting) {
  const TempFolder folder;
  expect_says(error_of_file(folder.path("absent.glb")), "absent.glb: no such file");
  expect_says(error_of_file(folder.path("")), "is a folder");
  const std::string fifo = folder.path("pipe.glb");
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  expect_says(error_of_file(fifo), "pipe.glb: is not a regular file");
  expect_says(error_of_file(folder.write("empty.glb", std::string())), "empty.glb: is empty");
}

TEST(GltfError, ATruncatedGlbIsRefusedAtEveryLength) {
  const Bytes whole = one_triangle().glb();
  const TempFolder folder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string path =
        folder.write("cut.glb", Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size)));
    expect_says(error_of_file(path), "cut.glb: ");
  }
}

TEST(GltfError, EveryByteOfAGlbMayBeWrongWithoutACrash) {
  const Bytes whole = one_triangle().glb();
  const TempFolder folder;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    Bytes damaged = whole;
    damaged[at] ^= 0x15;
    const std::string path = folder.write("damaged.glb", damaged);
    try {
      load_gltf(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << "byte " << at;
    }
  }
}

TEST(GltfError, DeepJsonIsRefusedBeforeItIsParsed) {
  const TempFolder folder;
  const std::string deep = "{\"asset\":" + std::string(1000000, '[');
  expect_says(error_of_file(folder.write("deep.gltf", deep)), "deep.gltf: JSON is nested deeper");
}

TEST(GltfError, BrokenJsonIsReportedWithItsPlace) {
  const TempFolder folder;
  expect_says(error_of_file(folder.write("typo.gltf", std::string("{\n\"asset\": }"))), "line 2");
}

TEST(GltfError, OtherVersionsAreRefused) {
  GltfBuilder builder = one_triangle();
  builder.doc["asset"]["version"] = "1.0";
  expect_says(error_of(builder), "is glTF 1.0");
}

TEST(GltfError, UnknownRequiredExtensionsAreNamed) {
  for (const char* name :
       {"KHR_meshopt_compression", "KHR_texture_basisu", "EXT_texture_avif", "ACME_secret"}) {
    GltfBuilder builder = one_triangle();
    builder.doc["extensionsRequired"] = {name};
    expect_says(error_of(builder), name);
  }
  GltfBuilder builder = one_triangle();
  builder.doc["extensionsUsed"] = {"ACME_secret"};
  builder.doc["extensionsRequired"] = {"KHR_materials_transmission", "KHR_texture_transform"};
  EXPECT_EQ(world_triangles(builder.load()).size(), 1u);
}

TEST(GltfError, ASceneWithoutTrianglesIsRefused) {
  GltfBuilder builder;
  builder.add("nodes", json::object());
  expect_says(error_of(builder), "scene.glb: has no triangles");
}

TEST(GltfError, AnIndexBeyondTheVerticesNamesMeshAndPrimitive) {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["name"] = "leaves";
  builder.doc["meshes"][0]["primitives"][0]["indices"] =
      builder.add_accessor(std::vector<std::uint16_t>{0, 1, 65535}, kUint16, "SCALAR");
  expect_says(error_of(builder),
              "mesh 0 (\"leaves\") primitive 0: index 2 names vertex 65,535, but there are 3");
}

TEST(GltfError, AttributesOfDifferentLengthAreRefused) {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      builder.add_accessor(std::vector<float>{0, 0}, kFloat, "VEC2");
  expect_says(error_of(builder), "mesh 0 primitive 0 has 3 vertices, but 1 of TEXCOORD_0");
}

TEST(GltfError, SparseIndicesMustIncreaseAndStayInside) {
  GltfBuilder builder = one_triangle();
  const int at = builder.add_view(pack<std::uint8_t>({0, 3}));
  const int values = builder.add_view(Bytes(24, 0));
  builder.doc["accessors"][0]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", at}, {"componentType", kUint8}}},
      {"values", {{"bufferView", values}}}};
  expect_says(error_of(builder), "accessor 0: sparse index 1 is 3");
  builder.doc["accessors"][0]["sparse"]["count"] = 3;
  expect_says(error_of(builder), "accessor 0 sparse.indices reads past bufferView 1");
}

TEST(GltfError, ChainsOfNodesEndAtSomeDepth) {
  const auto chain = [](int length) {
    GltfBuilder builder = one_triangle();
    for (int i = 0; i + 1 < length; ++i) {
      builder.add("nodes", {{"children", {static_cast<int>(builder.doc["nodes"].size()) - 1}}});
    }
    return builder;
  };
  EXPECT_EQ(world_triangles(chain(1024).load()).size(), 1u);
  expect_says(error_of(chain(65537)), "is nested deeper than 65,536 nodes");
}

TEST(GltfError, InstanceAttributesOfDifferentLengthAreRefused) {
  GltfBuilder builder = one_triangle();
  const int one = builder.add_positions({0, 0, 0});
  const int two = builder.add_positions({1, 1, 1, 1, 1, 1});
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", one}, {"SCALE", two}};
  expect_says(error_of(builder), "node 0: instance attributes differ in length");
}

/// A triangle whose material takes its alpha from texture 0.
GltfBuilder blended() {
  GltfBuilder builder = one_triangle();
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  builder.doc["materials"] = {{{"name", "leaf"},
                               {"alphaMode", "MASK"},
                               {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  builder.add("textures", {{"source", 0}});
  return builder;
}

TEST(GltfError, AnAbsentImageWhoseAlphaCountsIsNamed) {
  GltfBuilder builder = blended();
  builder.add("images", {{"uri", "leaf.png"}});
  const std::string message = error_of(builder);
  expect_says(message, "image 0 (leaf.png) of material 0 (\"leaf\"): no such file");
}

TEST(GltfError, ACorruptImageWhoseAlphaCountsIsNamed) {
  GltfBuilder builder = blended();
  const Bytes image = png::with_alpha(8, 8, Bytes(64, 9));
  const int view = builder.add_view(Bytes(image.begin(), image.begin() + 90));
  builder.add("images", {{"bufferView", view}, {"name", "atlas"}});
  expect_says(error_of(builder), "image 0 (atlas) of material 0 (\"leaf\"): is corrupt");
  builder.doc["bufferViews"][view]["byteLength"] = 4;
  expect_says(error_of(builder), "is none of PNG, JPEG and WebP");
}

TEST(GltfError, AnImageTooLargeIsRefusedByItsHeader) {
  const auto error_of_size = [](std::uint32_t side, std::uint8_t color_type) {
    GltfBuilder builder = blended();
    const int view = builder.add_view(png::encode(side, side, 8, color_type, {}));
    builder.add("images", {{"bufferView", view}});
    return error_of(builder);
  };
  constexpr std::uint8_t kGrey = 0;
  constexpr std::uint8_t kRgba = 6;
  expect_says(error_of_size(20000, kGrey), "is too large (20000 x 20000 pixels");
  expect_says(error_of_size(20000, kRgba), "is too large");
  expect_says(error_of_size(20000000, kGrey), "is too large");
}

TEST(GltfError, ATextureOfAnotherFormatAloneIsNamed) {
  GltfBuilder builder = blended();
  builder.add("images", {{"uri", "leaf.avif"}});
  builder.doc["textures"][0] = {{"extensions", {{"EXT_texture_avif", {{"source", 0}}}}}};
  expect_says(error_of(builder), "exists only as EXT_texture_avif");
}

TEST(GltfError, AnImageBehindASymbolicLinkOutOfTheFolderIsRefused) {
  GltfBuilder builder = blended();
  builder.add("images", {{"uri", "link.png"}});
  const TempFolder outside;
  const TempFolder folder;
  const std::string target = outside.write("leaf.png", png::with_alpha(1, 1, {9}));
  std::filesystem::create_symlink(target, folder.path("link.png"));
  expect_says(error_of_file(folder.write("scene.glb", builder.glb())), "leads out of");
}

}  // namespace
}  // namespace dapple::test
