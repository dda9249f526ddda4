// Files that EXT_meshopt_compression compresses are read as their plain copies are.
#include "scene/gltf/document/compressed_views.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "support/files/compressed_gltf.hpp"

namespace dapple::test {
namespace {

/// A bumpy sheet of 20 x 20 quads.
template <class Index>
GltfBuilder sheet(int component) {
  constexpr int kSide = 21;
  GltfBuilder builder;
  std::vector<float> positions;
  std::vector<Index> indices;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float u = 0.1f * static_cast<float>(x), v = 0.1f * static_cast<float>(y);
      positions.insert(positions.end(), {u, std::sin(3 * u) * std::cos(5 * v), v});
      if (x == 0 || y == 0) continue;
      const int at = y * kSide + x;
      for (const int offset : {0, -1, -kSide, -kSide, -1, -kSide - 1})
        indices.push_back(static_cast<Index>(at + offset));
    }
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(positions)}}},
                    {"indices", builder.add_accessor(indices, component, "SCALAR")}});
  return builder;
}

/// A triangle begins at its least corner.
std::multiset<std::array<float, 9>> turned(const Scene& scene) {
  std::multiset<std::array<float, 9>> all;
  for (const Triangle& triangle : world_triangles(scene)) {
    std::array<float, 9> least;
    for (std::size_t first = 0; first < 3; ++first) {
      std::array<float, 9> numbers;
      for (std::size_t i = 0; i < 9; ++i)
        numbers[i] = triangle[(first + i / 3) % 3][static_cast<int>(i % 3)];
      if (first == 0 || numbers < least) least = numbers;
    }
    all.insert(least);
  }
  return all;
}

TEST(CompressedViews, AreReadAsTheirPlainCopiesToTheBit) {
  for (const GltfBuilder& plain : {sheet<std::uint16_t>(kUint16), sheet<std::uint32_t>(kUint32)}) {
    const std::vector<Triangle> triangles = world_triangles(plain.load());
    EXPECT_EQ(triangles.size(), 800u);
    const GltfBuilder small = compressed(plain);
    EXPECT_LT(small.bin.size(), plain.bin.size());
    EXPECT_EQ(world_triangles(small.load()), triangles);
  }
}

TEST(CompressedViews, OfTrianglesHoldTheSameTriangles) {
  const GltfBuilder plain = sheet<std::uint16_t>(kUint16);
  EXPECT_EQ(turned(compressed(plain, true).load()), turned(plain.load()));
}

TEST(CompressedViews, AFallbackBufferThatHasBytesIsReadItself) {
  const TempFolder folder;
  const GltfBuilder plain = one_triangle();
  GltfBuilder both = compressed(plain);
  both.doc["buffers"][1]["uri"] = "plain.bin";
  folder.write("plain.bin", plain.bin);
  both.bin.assign(both.bin.size(), 0);  // the compressed data are not needed
  EXPECT_EQ(world_triangles(load_gltf(folder.write("scene.glb", both.glb()))),
            world_triangles(plain.load()));
}

// Multiples of 1/4 are 2^-2 times a whole number, without an error.
TEST(CompressedViews, TheExponentialFilterIsUndone) {
  const std::vector<float> positions = {0, 0.25f, -3, 1, 0, 2.5f, 0, 1024, 0.75f};
  Bytes filtered(36);
  meshopt_encodeFilterExp(filtered.data(), 3, 12, 24, positions.data());
  CompressedViews views;
  const int view =
      views.add(encoded_attributes(filtered, 3, 12), 3, 12, "ATTRIBUTES", "EXPONENTIAL");
  GltfBuilder builder = views.finished();
  const int accessor = builder.add(
      "accessors",
      {{"bufferView", view}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  builder.add_mesh({{"attributes", {{"POSITION", accessor}}}});
  const Triangle triangle = world_triangles(builder.load()).at(0);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(triangle[i / 3][static_cast<int>(i % 3)], positions[i]);
}

/// A triangle with normals whose octahedral form fills `stride` bytes a vertex.
GltfBuilder with_normals(const std::vector<float>& normals, int stride, int component) {
  std::vector<float> padded;
  for (std::size_t i = 0; i < 3; ++i)
    padded.insert(padded.end(), {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2], 0});
  const auto size = static_cast<std::size_t>(stride);
  Bytes filtered(3 * size);
  meshopt_encodeFilterOct(filtered.data(), 3, size, 2 * stride, padded.data());
  CompressedViews views;
  const int view =
      views.add(encoded_attributes(filtered, 3, size), 3, size, "ATTRIBUTES", "OCTAHEDRAL");
  views.out.doc["bufferViews"][view]["byteStride"] = stride;
  const int positions =
      views.add(encoded_attributes(pack(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}), 3, 12), 3,
                12, "ATTRIBUTES");
  GltfBuilder builder = views.finished();
  const int normal = builder.add("accessors", {{"bufferView", view},
                                               {"componentType", component},
                                               {"normalized", true},
                                               {"count", 3},
                                               {"type", "VEC3"}});
  const int position = builder.add(
      "accessors",
      {{"bufferView", positions}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  builder.add_mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
  return builder;
}

// Directions of 8 bits an axis are 0.5/127 off along each, and a little more when they are folded.
TEST(CompressedViews, TheOctahedralFilterIsUndone) {
  const std::vector<float> normals = {0.6f, 0, 0.8f, 0, -0.6f, 0.8f, 0.48f, 0.6f, 0.64f};
  for (const auto& [stride, component, error] :
       {std::tuple{4, kInt8, 0.012f}, std::tuple{8, kInt16, 5e-5f}}) {
    const Scene scene = with_normals(normals, stride, component).load();
    ASSERT_EQ(scene.meshes.at(0).normals.size(), 3u);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(scene.meshes[0].normals[i / 3][static_cast<int>(i % 3)], normals[i], error)
          << stride;
  }
}

TEST(CompressedViews, TheQuaternionFilterIsUndone) {
  const std::vector<float> turn = {0.1f, 0.7f, -0.1f, 0.7f};
  Bytes filtered(8);
  meshopt_encodeFilterQuat(filtered.data(), 1, 8, 16, turn.data());
  CompressedViews views;
  const int view = views.add(encoded_attributes(filtered, 1, 8), 1, 8, "ATTRIBUTES", "QUATERNION");
  GltfBuilder packed = views.finished();
  packed.add_mesh({{"attributes", {{"POSITION", 0}}}});
  packed.doc["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", (packed.bin.size() + 3) / 4 * 4}, {"byteLength", 36}});
  packed.bin.resize((packed.bin.size() + 3) / 4 * 4);
  for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    append(packed.bin, number);
  packed.doc["buffers"][0]["byteLength"] = packed.bin.size();
  packed.add("accessors",
             {{"bufferView", 1}, {"componentType", kFloat}, {"count", 3}, {"type", "VEC3"}});
  const int rotation = packed.add("accessors", {{"bufferView", view},
                                                {"componentType", kInt16},
                                                {"normalized", true},
                                                {"count", 1},
                                                {"type", "VEC4"}});
  packed.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"ROTATION", rotation}};
  GltfBuilder plain = one_triangle();
  plain.doc["nodes"][0]["rotation"] = turn;
  const Triangle expected = world_triangles(plain.load()).at(0);
  const Triangle triangle = world_triangles(packed.load()).at(0);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_LT((triangle[c] - expected[c]).length(), 2e-4f) << c;
}

/// The error of a compressed triangle whose first view is changed.
std::string error_with(const char* key, const json& value, bool of_extension = true) {
  GltfBuilder builder = compressed(one_triangle());
  json& view = builder.doc["bufferViews"][0];
  (of_extension ? view["extensions"][kMeshopt] : view)[key] = value;
  return error_of(builder);
}

TEST(CompressedViews, ThatCannotBeAreNamed) {
  expect_says(error_with("count", 4), "has 36 bytes, but 4 compressed elements of 12");
  expect_says(error_with("byteStride", 6), "compressed elements of 6 bytes (ATTRIBUTES, NONE)");
  expect_says(error_with("byteStride", 260), "compressed elements of 260 bytes");
  expect_says(error_with("filter", "OCTAHEDRAL"), "of 12 bytes (ATTRIBUTES, OCTAHEDRAL)");
  expect_says(error_with("mode", "TRIANGLES"), "of 12 bytes (TRIANGLES, NONE)");
  expect_says(error_with("mode", "POINTS"), "mode is \"POINTS\", not one of ATTRIBUTES");
  expect_says(error_with("filter", "COLOR"), "filter is \"COLOR\"");
  expect_says(error_with("buffer", 7), "names buffer 7, but there are 2");
  expect_says(error_with("byteLength", 1 << 20), "bufferView 0 (compressed) reads past buffer 0");
  expect_says(error_with("byteLength", 8), "bufferView 0 has compressed data that are damaged");
  expect_says(error_with("byteOffset", 4, false), "bufferView 0 reads past its buffer");
  expect_says(error_with("extensions", json::object(), false),
              "bufferView 0 is in a buffer without bytes, and is not compressed");
}

TEST(CompressedViews, ABufferThatNothingCouldFillTakesNoMemory) {
  GltfBuilder builder = compressed(one_triangle());
  builder.doc["buffers"][1]["byteLength"] = std::uint64_t{1} << 31;
  expect_says(error_of(builder), "buffer 1 has 2,147,483,648 bytes without their data");
}

// Each of them alone would be as large as its data may become.
TEST(CompressedViews, ManyBuffersThatNothingCouldFillTakeNoMemory) {
  GltfBuilder builder = compressed(one_triangle());
  for (int i = 0; i < 1000; ++i) builder.doc["buffers"].push_back(builder.doc["buffers"][1]);
  const std::size_t each = 60 * builder.glb().size();
  for (std::size_t i = 1; i < builder.doc["buffers"].size(); ++i)
    builder.doc["buffers"][i]["byteLength"] = each;
  expect_says(error_of(builder), "buffer 2 has");
}

TEST(CompressedViews, OfTheLaterExtensionHaveNoBytes) {
  GltfBuilder builder = compressed(one_triangle());
  json& extensions = builder.doc["buffers"][1]["extensions"];
  extensions = {{"KHR_meshopt_compression", {{"fallback", true}}}};
  builder.doc["extensionsRequired"] = {"KHR_meshopt_compression"};
  expect_says(error_of(builder), "requires the extension KHR_meshopt_compression");
  builder.doc.erase("extensionsRequired");
  expect_says(error_of(builder), "buffer 1: holds only KHR_meshopt_compression data");
}

}  // namespace
}  // namespace dapple::test
