// Files that KHR_draco_mesh_compression compresses are read as the values that Draco's own decoder
// gives them. What does not fit is an error.
#include "scene/gltf/document/compressed_primitives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/files/draco_gltf.hpp"
#include "support/same_bits.hpp"
#include "support/scenes/garden.hpp"

namespace dapple::test {
namespace {

/// A bumpy sheet of `side` x `side` vertices with all that a primitive may have; its alpha is read
/// from COLOR_0 and from a texture.
template <class Index>
GltfBuilder sheet(int component, int side) {
  GltfBuilder builder;
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint16_t> colors;
  std::vector<Index> indices;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const float u = 0.1f * static_cast<float>(x), v = 0.1f * static_cast<float>(y);
      positions.insert(positions.end(), {u, std::sin(3 * u) * std::cos(5 * v), v});
      normals.insert(normals.end(), {0.6f * std::sin(u), 0.8f, 0.6f * std::cos(u)});
      uvs.insert(uvs.end(), {u, 0.3f * v});
      for (const int c : {x, y, x + y, 3 * x})
        colors.push_back(static_cast<std::uint16_t>(c * 65535 / (3 * side)));
      if (x == 0 || y == 0) continue;
      const int at = y * side + x;
      for (const int offset : {0, -1, -side, -side, -1, -side - 1})
        indices.push_back(static_cast<Index>(at + offset));
    }
  const int image = builder.add(
      "images", {{"bufferView", builder.add_view(png::with_alpha(2, 2, {255, 9, 0, 200}))},
                 {"mimeType", "image/png"}});
  builder.add("textures", {{"source", image}});
  builder.add("materials",
              {{"alphaMode", "BLEND"},
               {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}}});
  builder.add_mesh({{"attributes",
                     {{"POSITION", builder.add_positions(positions)},
                      {"NORMAL", builder.add_positions(normals)},
                      {"TEXCOORD_0", builder.add_accessor(normals, kFloat, "VEC2")},
                      {"TEXCOORD_1", builder.add_accessor(uvs, kFloat, "VEC2")},
                      {"COLOR_0", builder.add_accessor(colors, kUint16, "VEC4", true)}}},
                    {"indices", builder.add_accessor(indices, component, "SCALAR")},
                    {"material", 0}});
  // TEXCOORD_0 has as many elements as the others.
  builder.doc["accessors"][2]["count"] = side * side;
  return builder;
}

GltfBuilder small_sheet() { return sheet<std::uint16_t>(kUint16, 21); }

SceneOptions with_colors() {
  SceneOptions options;
  options.colors = true;
  return options;
}

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    EXPECT_FALSE(a.meshes[m].positions.empty());
    EXPECT_TRUE(same_bits(a.meshes[m].positions, b.meshes[m].positions)) << m;
    EXPECT_TRUE(same_bits(a.meshes[m].normals, b.meshes[m].normals)) << m;
    EXPECT_TRUE(same_bits(a.meshes[m].uvs, b.meshes[m].uvs)) << m;
    EXPECT_TRUE(same_bits(a.meshes[m].colors, b.meshes[m].colors)) << m;
    EXPECT_TRUE(same_bits(a.meshes[m].vertex_alpha, b.meshes[m].vertex_alpha)) << m;
    EXPECT_EQ(a.meshes[m].indices, b.meshes[m].indices) << m;
    EXPECT_EQ(a.meshes[m].materials, b.meshes[m].materials) << m;
  }
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(world_triangles(a), world_triangles(b));
}

TEST(CompressedPrimitives, AreReadAsDracosOwnDecoderDecodesThem) {
  for (const GltfBuilder& plain :
       {sheet<std::uint8_t>(kUint8, 15), small_sheet(), sheet<std::uint32_t>(kUint32, 21)})
    for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING})
      for (const int bits : {0, 11})
        for (const int speed : {0, 5, 10}) {
          SCOPED_TRACE(testing::Message() << method << " " << bits << " " << speed);
          const GltfBuilder small =
              draco_compressed(plain, {.method = method, .bits = bits, .speed = speed});
          const Scene scene = small.load(with_colors());
          EXPECT_EQ(scene.meshes.at(0).uvs.size(), scene.meshes[0].positions.size());
          EXPECT_EQ(scene.meshes[0].colors.size(), scene.meshes[0].positions.size());
          EXPECT_EQ(scene.meshes[0].vertex_alpha.size(), scene.meshes[0].positions.size());
          expect_same(scene, draco_decoded(small).load(with_colors()));
        }
}

/// Sorted, since a triangle may begin at another corner.
std::vector<std::array<V3f, 3>> sorted(std::vector<Triangle> triangles) {
  const auto less = [](const V3f& a, const V3f& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  for (Triangle& t : triangles)
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
  std::sort(triangles.begin(), triangles.end(), [&](const Triangle& a, const Triangle& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less);
  });
  return triangles;
}

TEST(CompressedPrimitives, WithoutQuantizationAreTheTrianglesOfThePlainFile) {
  const GltfBuilder plain = small_sheet();
  EXPECT_EQ(sorted(world_triangles(draco_compressed(plain).load())),
            sorted(world_triangles(plain.load())));
}

// Two primitives that share vertices, a morph target, a vertex that nothing uses, a strip, integer
// positions, and a primitive that stays plain.
TEST(CompressedPrimitives, AGardenIsReadAsItsPlainCopy) {
  const GltfBuilder plain = Garden().file;
  const GltfBuilder small = draco_compressed(plain);
  ASSERT_TRUE(small.doc["meshes"][0]["primitives"][1].contains("extensions"));
  expect_same(small.load(with_colors()), draco_decoded(small).load(with_colors()));
}

TEST(CompressedPrimitives, AStripIsTheTrianglesThatTheStreamHas) {
  GltfBuilder strip;
  strip.add_mesh(
      {{"attributes",
        {{"POSITION", strip.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 1})}}},
       {"indices",
        strip.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 3, 4}, kUint16, "SCALAR")},
       {"mode", 5}});
  const GltfBuilder small = draco_compressed(strip);
  EXPECT_EQ(small.doc["meshes"][0]["primitives"][0]["mode"], 5);
  EXPECT_EQ(sorted(world_triangles(small.load())), sorted(world_triangles(strip.load())));
}

TEST(CompressedPrimitives, JointsAndWeightsMoveTheDecodedVertices) {
  GltfBuilder plain = small_sheet();
  json& attributes = plain.doc["meshes"][0]["primitives"][0]["attributes"];
  std::vector<std::uint8_t> joints, weights;
  for (int i = 0; i < 21 * 21; ++i) {
    const auto weight = static_cast<std::uint8_t>(i % 256);
    joints.insert(joints.end(), {0, 1, 0, 0});
    weights.insert(weights.end(), {weight, static_cast<std::uint8_t>(255 - weight), 0, 0});
  }
  attributes["JOINTS_0"] = plain.add_accessor(joints, kUint8, "VEC4");
  attributes["WEIGHTS_0"] = plain.add_accessor(weights, kUint8, "VEC4", true);
  plain.doc["nodes"][0]["skin"] = 0;
  plain.add("nodes", {{"translation", {0, 1, 0}}});
  plain.add("nodes", {{"translation", {0, 0, 2}}});
  plain.add("skins", {{"joints", {1, 2}}});
  const GltfBuilder small = draco_compressed(plain, {.bits = 12});
  expect_same(small.load(), draco_decoded(small).load());
  EXPECT_NE(world_triangles(small.load()), world_triangles(draco_compressed(small_sheet()).load()));
}

TEST(CompressedPrimitives, AttributesThatAreNotCompressedAreReadAsUsual) {
  const GltfBuilder plain = small_sheet();
  const GltfBuilder small = draco_compressed(
      plain, {.method = draco::MESH_SEQUENTIAL_ENCODING, .left_plain = {"COLOR_0", "NORMAL"}});
  EXPECT_TRUE(small.doc["accessors"][4].contains("bufferView"));
  expect_same(small.load(with_colors()), plain.load(with_colors()));
}

// Colours as floats in the file, though the stream has bytes, become what viewers show.
TEST(CompressedPrimitives, ValuesHaveTheTypeOfTheirAccessors) {
  GltfBuilder small = draco_compressed(small_sheet());
  json& primitive = small.doc["meshes"][0]["primitives"][0];
  json& accessor = small.doc["accessors"][primitive["attributes"]["COLOR_0"].get<std::size_t>()];
  const Scene integers = small.load(with_colors());
  accessor["componentType"] = kFloat;
  accessor.erase("normalized");
  EXPECT_TRUE(
      same_bits(small.load(with_colors()).meshes.at(0).colors, integers.meshes.at(0).colors));
  accessor["componentType"] = kUint8;
  expect_says(error_of(small),
              "COLOR_0 has Draco data with values that its accessor's type cannot");
}

TEST(CompressedPrimitives, CompressedDataComeBeforeAFallback) {
  GltfBuilder both = draco_compressed(small_sheet(), {.with_fallback = true});
  EXPECT_FALSE(both.doc.contains("extensionsRequired"));
  const GltfBuilder plain = draco_decoded(both);
  const std::size_t position =
      both.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<std::size_t>();
  const std::size_t view = both.doc["accessors"][position]["bufferView"].get<std::size_t>();
  both.bin[both.doc["bufferViews"][view]["byteOffset"].get<std::size_t>() + 3] = 66;
  expect_same(both.load(), plain.load());
}

// The sheet once more, lower: its accessors are the first one's, its stream is not.
TEST(CompressedPrimitives, StreamsMayShareAccessors) {
  GltfBuilder plain = small_sheet(), lower = plain;
  const std::size_t positions = plain.doc["bufferViews"][1]["byteOffset"];
  for (std::size_t i = 0; i < 21 * 21; ++i) lower.bin[positions + 12 * i + 7] ^= 0x80;  // -y
  const GltfBuilder first = draco_compressed(plain), second = draco_compressed(lower);
  GltfBuilder both = first;
  const json extension = second.doc["meshes"][0]["primitives"][0]["extensions"][kDraco];
  const json& view = second.doc["bufferViews"][extension["bufferView"].get<std::size_t>()];
  const auto begin = second.bin.begin() + view["byteOffset"].get<std::ptrdiff_t>();
  json other = both.doc["meshes"][0]["primitives"][0];
  other["extensions"][kDraco]["bufferView"] =
      both.add_view(Bytes(begin, begin + view["byteLength"].get<std::ptrdiff_t>()));
  both.doc["meshes"][0]["primitives"].push_back(other);
  both.doc["meshes"][0]["primitives"].push_back(both.doc["meshes"][0]["primitives"][0]);
  std::vector<Triangle> expected = world_triangles(first.load());
  const std::vector<Triangle> again = expected, lowered = world_triangles(second.load());
  EXPECT_NE(lowered, again);
  expected.insert(expected.end(), lowered.begin(), lowered.end());
  expected.insert(expected.end(), again.begin(), again.end());
  EXPECT_EQ(world_triangles(both.load()), expected);
}

TEST(CompressedPrimitives, MayHaveMoreIndicesThanAccessorsOfZerosMay) {
  GltfBuilder plain = one_triangle();
  std::vector<std::uint8_t> indices;
  while (indices.size() <= std::size_t{1} << 22) indices.insert(indices.end(), {0, 1, 2});
  plain.doc["meshes"][0]["primitives"][0]["indices"] =
      plain.add_accessor(indices, kUint8, "SCALAR");
  const GltfBuilder small =
      draco_compressed(plain, {.method = draco::MESH_SEQUENTIAL_ENCODING, .speed = 10});
  EXPECT_EQ(world_triangles(small.load()).size(), indices.size() / 3);
}

/// A compressed triangle, whose first primitive a test may change.
struct CompressedTriangle {
  CompressedTriangle() {
    GltfBuilder plain = one_triangle();
    plain.doc["meshes"][0]["name"] = "leaf";
    plain.doc["meshes"][0]["primitives"][0]["indices"] =
        plain.add_accessor(std::vector<std::uint16_t>{0, 1, 2}, kUint16, "SCALAR");
    file = draco_compressed(plain, {.method = draco::MESH_SEQUENTIAL_ENCODING});
  }
  json& primitive() { return file.doc["meshes"][0]["primitives"][0]; }
  json& extension() { return primitive()["extensions"][kDraco]; }
  json& accessor(const json& index) { return file.doc["accessors"][index.get<std::size_t>()]; }
  json& view() { return file.doc["bufferViews"][extension()["bufferView"].get<std::size_t>()]; }
  std::uint8_t& byte(std::size_t i) {
    return file.bin.at(view()["byteOffset"].get<std::size_t>() + i);
  }

  GltfBuilder file;
};

template <class Edit>
std::string error_after(const Edit& edit) {
  CompressedTriangle triangle;
  edit(triangle);
  return error_of(triangle.file);
}

TEST(CompressedPrimitives, ThatDoNotFitTheirAccessorsAreNamed) {
  using T = CompressedTriangle;
  const std::string who = "mesh 0 (\"leaf\") primitive 0";
  expect_says(
      error_after([](T& t) { t.accessor(t.primitive()["attributes"]["POSITION"])["count"] = 4; }),
      who + " POSITION has 4 vertices in accessor");
  expect_says(error_after([](T& t) { t.accessor(t.primitive()["indices"])["count"] = 6; }),
              who + " indices has 6 indices in accessor");
  expect_says(error_after([](T& t) { t.accessor(t.primitive()["indices"])["type"] = "VEC2"; }),
              who + " indices is accessor");
  expect_says(error_after([](T& t) { t.extension()["attributes"]["POSITION"] = 8; }),
              who + " POSITION is attribute 8 of Draco data, which lack it");
  expect_says(error_after([](T& t) {
                t.accessor(t.primitive()["attributes"]["POSITION"])["type"] = "VEC4";
              }),
              who + " POSITION has 4 components in its accessor, but 3");
  expect_says(error_after([](T& t) { t.primitive()["attributes"]["POSITION"] = 99; }),
              who + " POSITION names accessor 99");
  expect_says(error_after([](T& t) { t.primitive()["indices"] = 99; }),
              who + " indices names accessor 99");
  expect_says(error_after([](T& t) { t.primitive()["mode"] = 1; }), who + " is of mode 1");
}

TEST(CompressedPrimitives, WithoutAStreamAreNamed) {
  using T = CompressedTriangle;
  const std::string where = "mesh 0 primitive 0 extensions KHR_draco_mesh_compression: ";
  expect_says(error_after([](T& t) { t.extension().erase("bufferView"); }),
              where + "bufferView is missing");
  expect_says(error_after([](T& t) { t.extension().erase("attributes"); }),
              where + "attributes is missing");
  expect_says(error_after([](T& t) { t.extension()["bufferView"] = 77; }),
              "primitive 0 (compressed) names bufferView 77");
  expect_says(error_after([](T& t) { t.view()["byteLength"] = 1 << 20; }), "reads past buffer 0");
  expect_says(error_after([](T& t) { t.view()["buffer"] = 3; }), "names buffer 3");
}

TEST(CompressedPrimitives, WhoseStreamIsNotOneAreNamed) {
  using T = CompressedTriangle;
  const std::string who = "mesh 0 (\"leaf\") primitive 0 has ";
  expect_says(error_after([](T& t) { t.byte(0) = 'd'; }),
              who + "data that do not begin as Draco's");
  expect_says(error_after([](T& t) { t.view()["byteLength"] = 5; }),
              who + "data that do not begin");
  expect_says(error_after([](T& t) { t.byte(6) = 1; }), who + "Draco data of version 2.1");
  expect_says(error_after([](T& t) { t.byte(7) = 0; }), who + "Draco data of points");
  expect_says(error_after([](T& t) { t.byte(8) = 9; }), who + "Draco data of an unknown method, 9");
  expect_says(error_after([](T& t) { t.view()["byteLength"] = 30; }),
              who + "Draco data that are damaged (");
  expect_says(error_after([](T& t) { t.byte(14) = 200; }), who + "Draco data");
}

// Counts of 2^32 - 1 in varints, which the decoders would allocate before they read on.
TEST(CompressedPrimitives, StreamsThatSayToBeHugeTakeNoMemory) {
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    Bytes stream = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, static_cast<std::uint8_t>(method), 0, 0};
    if (method == draco::MESH_EDGEBREAKER_ENCODING) stream.push_back(0);
    for (const int byte : {3, 0xff, 0xff, 0xff, 0xff, 3})
      stream.push_back(static_cast<std::uint8_t>(byte));
    for (int i = 0; i < 60; ++i) stream.push_back(1);
    CompressedTriangle triangle;
    triangle.extension()["bufferView"] = triangle.file.add_view(stream);
    expect_says(error_of(triangle.file), "bytes of Draco data say that decoding them takes");
  }
}

// Attributes that are zero everywhere take some bytes of the stream, however many vertices there
// are.
TEST(CompressedPrimitives, AttributesThatTakeNoBytesAreCounted) {
  GltfBuilder plain = sheet<std::uint32_t>(kUint32, 100);
  json& attributes = plain.doc["meshes"][0]["primitives"][0]["attributes"];
  const int zeros = plain.add_accessor(std::vector<float>(4 * 100 * 100), kFloat, "VEC4");
  attributes = {{"POSITION", attributes["POSITION"]}};
  for (int i = 0; i < 700; ++i) attributes["_A" + std::to_string(i)] = zeros;
  const GltfBuilder small = draco_compressed(plain, {.bits = 8, .speed = 10});
  GltfBuilder alone = small;  // without the plain data, which would allow more memory
  json& extension = alone.doc["meshes"][0]["primitives"][0]["extensions"][kDraco];
  const json view = small.doc["bufferViews"][extension["bufferView"].get<std::size_t>()];
  const auto begin = small.bin.begin() + view["byteOffset"].get<std::ptrdiff_t>();
  alone.bin = Bytes(begin, begin + view["byteLength"].get<std::ptrdiff_t>());
  alone.doc["bufferViews"] = {{{"buffer", 0}, {"byteLength", alone.bin.size()}}};
  extension["bufferView"] = 0;
  for (const char* array : {"images", "textures", "materials"}) alone.doc.erase(array);
  alone.doc["meshes"][0]["primitives"][0]["attributes"] = {
      {"POSITION", small.doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"]}};
  expect_says(error_of(alone), "bytes of Draco data say that decoding them takes");
}

TEST(CompressedPrimitives, DamagedStreamsAreReadOrRefusedByName) {
  std::mt19937 random(7);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING})
    for (const int bits : {0, 10}) {
      const GltfBuilder sound =
          draco_compressed(sheet<std::uint8_t>(kUint8, 9), {.method = method, .bits = bits});
      const json& view =
          sound.doc["bufferViews"]
                   [sound.doc["meshes"][0]["primitives"][0]["extensions"][kDraco]["bufferView"]
                        .get<std::size_t>()];
      const std::size_t begin = view["byteOffset"], size = view["byteLength"];
      int refused = 0;
      for (int damage = 0; damage < 100; ++damage) {
        GltfBuilder damaged = sound;
        for (auto flips = 1 + random() % 3; flips > 0; --flips)
          damaged.bin[begin + 11 + random() % (size - 11)] = static_cast<std::uint8_t>(random());
        try {
          (void)damaged.load(with_colors());
        } catch (const Error& error) {
          EXPECT_EQ(error.kind(), ErrorKind::input);
          expect_says(error.what(), "scene.glb: mesh 0 primitive 0");
          ++refused;
        }
      }
      EXPECT_GT(refused, 0);
    }
}

}  // namespace
}  // namespace dapple::test
