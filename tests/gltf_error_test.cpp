// What the glTF reader refuses, and how: every case is an Error of kind input, of one
// line, that names the file, the element and the figures.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>

#include "gltf_builder.hpp"

namespace dapple::test {
namespace {

std::string error_of(const GltfBuilder& builder) {
  return input_error([&] { return builder.load(); });
}

std::string error_of_file(const std::string& path) {
  return input_error([&] { return load_gltf(path); });
}

void expect_says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos)
      << "\"" << message << "\" lacks \"" << part << "\"";
}

GltfBuilder one_triangle() {
  GltfBuilder builder;
  builder.add_triangle();
  return builder;
}

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
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                           "KHR_texture_basisu", "EXT_texture_webp", "ACME_secret"}) {
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

/// Each edits a sound document of one triangle; the message must hold the text.
struct Damage {
  const char* name;
  std::function<void(json&)> edit;
  const char* says;
};

const Damage kDamages[] = {
    {"AccessorPastItsView", [](json& d) { d["accessors"][0]["count"] = 4; },
     "accessor 0 reads past bufferView 0 (needs 48 bytes, has 36)"},
    {"AccessorOffsetPastItsView", [](json& d) { d["accessors"][0]["byteOffset"] = 4; },
     "accessor 0 reads past bufferView 0 (needs 40 bytes, has 36)"},
    {"AccessorCountThatOverflows64Bits",
     [](json& d) { d["accessors"][0]["count"] = 9007199254740991; },
     "accessor 0 reads past bufferView 0"},
    {"AccessorCountBelowZero", [](json& d) { d["accessors"][0]["count"] = -1; },
     "accessor 0: count is not an integer"},
    {"AccessorWithAnAbsurdCountOfZeros",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["accessors"][0]["count"] = 1000000000;
     },
     "accessor 0 has 1,000,000,000 elements but no bufferView"},
    {"AccessorInAnUnknownView", [](json& d) { d["accessors"][0]["bufferView"] = 7; },
     "accessor 0 names bufferView 7, but there are 1"},
    {"AccessorOfAnUnknownComponent", [](json& d) { d["accessors"][0]["componentType"] = 5124; },
     "accessor 0 has the unknown componentType 5124"},
    {"ViewPastItsBuffer", [](json& d) { d["bufferViews"][0]["byteOffset"] = 8; },
     "bufferView 0 reads past buffer 0 (needs 44 bytes, has 36)"},
    {"ViewInAnUnknownBuffer", [](json& d) { d["bufferViews"][0]["buffer"] = 1; },
     "bufferView 0 names buffer 1, but there are 1"},
    {"StrideBelowTheElement", [](json& d) { d["bufferViews"][0]["byteStride"] = 8; },
     "accessor 0 has elements of 12 bytes in bufferView 0 of byteStride 8"},
    {"StrideThatIsOdd", [](json& d) { d["bufferViews"][0]["byteStride"] = 13; },
     "bufferView 0: byteStride is not a multiple of 4"},
    {"BufferLongerThanItsBytes",
     [](json& d) {
       d["buffers"] = {{{"byteLength", 4096}}};
     },
     "buffer 0: is too short (byteLength is 4,096, it has 36)"},
    {"BufferFarAway",
     [](json& d) {
       d["buffers"] = {{{"uri", "https://example.org/a.bin"}, {"byteLength", 36}}};
     },
     "is not a relative path"},
    {"BufferOutsideTheFolder",
     [](json& d) {
       d["buffers"] = {{{"uri", "%2e%2e/a.bin"}, {"byteLength", 36}}};
     },
     "leads out of the scene's folder"},
    {"BufferAtAnAbsolutePath",
     [](json& d) {
       d["buffers"] = {{{"uri", "/etc/passwd"}, {"byteLength", 36}}};
     },
     "leads out of the scene's folder"},
    {"BufferThatIsAbsent",
     [](json& d) {
       d["buffers"] = {{{"uri", "a.bin"}, {"byteLength", 36}}};
     },
     "buffer 0 (a.bin): no such file"},
    {"BufferOfBadBase64",
     [](json& d) {
       d["buffers"] = {{{"uri", "data:;base64,A*AA"}, {"byteLength", 3}}};
     },
     "buffer 0: its data: URI holds a character that is not base64"},
    {"PrimitiveWithoutAttributes",
     [](json& d) { d["meshes"][0]["primitives"][0].erase("attributes"); },
     "mesh 0 primitive 0: attributes is missing"},
    {"PrimitiveOfAnUnknownAccessor",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 3; },
     "mesh 0 primitive 0 POSITION names accessor 3, but there are 1"},
    {"PrimitiveOfAnUnknownMaterial",
     [](json& d) { d["meshes"][0]["primitives"][0]["material"] = 0; },
     "mesh 0 primitive 0 names material 0, but there are 0"},
    {"PrimitiveOfAnUnknownMode", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 9; },
     "mesh 0 primitive 0 has the unknown mode 9"},
    {"PrimitiveWithPositionsOfTheWrongType", [](json& d) { d["accessors"][0]["type"] = "VEC2"; },
     "mesh 0 primitive 0 POSITION is accessor 0, which is VEC2 of float"},
    {"PrimitiveThatLacksACorner", [](json& d) { d["accessors"][0]["count"] = 2; },
     "mesh 0 primitive 0: 2 indices do not make whole triangles"},
    {"PrimitiveUnderDracoAlone",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
           {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
     },
     "mesh 0 primitive 0 exists only as KHR_draco_mesh_compression"},
    {"IndexCutTo32Bits", [](json& d) { d["nodes"][0]["mesh"] = 4294967296; },
     "node 0: mesh is not an integer"},
    {"NodeOfAnUnknownMesh", [](json& d) { d["nodes"][0]["mesh"] = 1; },
     "node 0 names mesh 1, but there are 1"},
    {"NodeOfAnUnknownChild", [](json& d) { d["nodes"][0]["children"] = {5}; },
     "node 0 names node 5, but there are 1"},
    {"NodeThatIsItsOwnChild", [](json& d) { d["nodes"][0]["children"] = {0}; },
     "node 0 is its own ancestor"},
    {"NodeWithTwoParents",
     [](json& d) {
       d["nodes"].push_back({{"children", {0}}});
       d["nodes"].push_back({{"children", {0}}});
     },
     "node 0 is a child of both node 1 and node 2"},
    {"NodeMatrixOfFifteen", [](json& d) { d["nodes"][0]["matrix"] = std::vector<int>(15, 1); },
     "node 0: matrix has 15 numbers, not 16"},
    {"NodeMatrixThatProjects",
     [](json& d) { d["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0}; },
     "node 0 has a matrix that is not affine"},
    {"NodeWithoutARotation",
     [](json& d) {
       d["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "node 0 has a rotation of length zero"},
    {"NodesOfUnrepresentableScale",
     [](json& d) {
       d["nodes"][0]["scale"] = {1e38, 1, 1};
       d["nodes"].push_back({{"children", {0}}, {"scale", {1e38, 1, 1}}});
     },
     "node 0 has a world matrix that is not finite"},
    {"SceneOfAnUnknownNode",
     [](json& d) {
       d["scenes"] = {{{"nodes", {4}}}};
     },
     "scene 0 names node 4, but there are 1"},
    {"SceneThatListsANodeTwice",
     [](json& d) {
       d["scenes"] = {{{"nodes", {0, 0}}}};
     },
     "scene 0 lists node 0 twice"},
    {"UnknownDefaultScene", [](json& d) { d["scene"] = 2; }, "names scene 2, but there are 0"},
    {"NodeOfAnUnknownLight",
     [](json& d) { d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; },
     "node 0 names light 0, but there are 0"},
    {"MaterialOfAnUnknownMode",
     [](json& d) {
       d["materials"] = {{{"name", "leaf"}, {"alphaMode", "GLASS"}}};
     },
     "material 0 (\"leaf\") has the unknown alphaMode \"GLASS\""},
    {"CameraThatSeesNothing",
     [](json& d) {
       d["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}}};
       d["nodes"][0]["camera"] = 0;
     },
     "camera 0 has yfov 0"},
    {"NameWithALineBreak",
     [](json& d) {
       d["nodes"][0]["name"] = "a\nb";
       d["nodes"][0]["mesh"] = 1;
     },
     "node 0 (\"a b\") names mesh 1"},
};

class GltfDamage : public testing::TestWithParam<Damage> {};

TEST_P(GltfDamage, IsRefusedByNameAndFigures) {
  GltfBuilder builder = one_triangle();
  GetParam().edit(builder.doc);
  const std::string message = error_of(builder);
  expect_says(message, GetParam().says);
  expect_says(message, "scene.glb: ");
}

INSTANTIATE_TEST_SUITE_P(Gltf, GltfDamage, testing::ValuesIn(kDamages),
                         [](const auto& instance) { return std::string(instance.param.name); });

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
  expect_says(error_of(chain(1025)), "is nested deeper than 1,024 nodes");
}

TEST(GltfError, InstanceAttributesOfDifferentLengthAreRefused) {
  GltfBuilder builder = one_triangle();
  const int one = builder.add_positions({0, 0, 0});
  const int two = builder.add_positions({1, 1, 1, 1, 1, 1});
  builder.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", one}, {"SCALE", two}};
  expect_says(error_of(builder), "node 0: instance attributes differ in length");
}

/// A triangle whose material blends with texture 0.
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
  expect_says(error_of(builder), "is neither a PNG nor a JPEG image");
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
  builder.add("images", {{"uri", "leaf.webp"}});
  builder.doc["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}};
  expect_says(error_of(builder), "exists only as EXT_texture_webp");
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
