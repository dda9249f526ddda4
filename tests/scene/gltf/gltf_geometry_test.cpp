// The glTF reader's geometry: all ways to store the same triangles in a file (indices, strips,
// fans, strides, sparse and quantized accessors) give the same triangles. Positions are small
// integers, so that they can be compared exactly.
#include <gtest/gtest.h>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

// A square in two triangles: vertices 0 1 / 3 2, counter-clockwise.
const std::vector<float> kSquare = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};

std::vector<Triangle> plain_square() {
  GltfBuilder builder;
  builder.add_mesh({{"attributes",
                     {{"POSITION", builder.add_positions(
                                       {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 0})}}}});
  return world_triangles(builder.load());
}

template <typename Index>
std::vector<Triangle> indexed_square(int component) {
  GltfBuilder builder;
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(kSquare)}}},
                    {"indices", builder.add_accessor(std::vector<Index>{0, 1, 2, 0, 2, 3},
                                                     component, "SCALAR")}});
  return world_triangles(builder.load());
}

bool same_cycle(const Triangle& a, const Triangle& b) {
  for (std::size_t turn = 0; turn < 3; ++turn) {
    if (a[0] == b[turn] && a[1] == b[(turn + 1) % 3] && a[2] == b[(turn + 2) % 3]) return true;
  }
  return false;
}

/// Compares triangles in order. Their winding must be equal, but they may begin with different
/// corners.
void expect_same_triangles(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_TRUE(same_cycle(a[i], b[i])) << "triangle " << i;
}

TEST(GltfGeometry, IndicesOfEveryWidthGiveTheTrianglesThatNoIndicesGive) {
  const auto plain = plain_square();
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_EQ(plain[1][2], V3f(0, 1, 0));
  EXPECT_EQ(indexed_square<std::uint8_t>(kUint8), plain);
  EXPECT_EQ(indexed_square<std::uint16_t>(kUint16), plain);
  EXPECT_EQ(indexed_square<std::uint32_t>(kUint32), plain);
}

TEST(GltfGeometry, AFanKeepsTheOrderAndWindingOfItsTriangles) {
  GltfBuilder builder;
  builder.add_mesh({{"attributes", {{"POSITION", builder.add_positions(kSquare)}}}, {"mode", 6}});
  expect_same_triangles(world_triangles(builder.load()), plain_square());
}

TEST(GltfGeometry, AStripTurnsEverySecondTriangleSoThatAllFaceTheSameWay) {
  GltfBuilder builder;
  builder.add_mesh(
      {{"attributes", {{"POSITION", builder.add_positions(kSquare)}}},
       {"indices", builder.add_accessor(std::vector<std::uint16_t>{0, 1, 3, 2}, kUint16, "SCALAR")},
       {"mode", 5}});
  const auto triangles = world_triangles(builder.load());
  ASSERT_EQ(triangles.size(), 2u);
  for (const Triangle& t : triangles) {
    EXPECT_GT((t[1] - t[0]).cross(t[2] - t[0]).z, 0.0f);
  }
}

TEST(GltfGeometry, AStripLosesTheTrianglesThatOnlyStitch) {
  GltfBuilder builder;
  builder.add_mesh(
      {{"attributes", {{"POSITION", builder.add_positions(kSquare)}}},
       {"indices", builder.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 2, 3, 3, 0, 2}, kUint16,
                                        "SCALAR")},
       {"mode", 5}});
  EXPECT_EQ(world_triangles(builder.load()).size(), 2u);
}

TEST(GltfGeometry, InterleavedVerticesAreReadByTheirStride) {
  GltfBuilder builder;
  Bytes bytes;
  for (std::size_t i = 0; i < kSquare.size(); i += 3) {
    append(bytes, -7.0f);  // another attribute
    for (std::size_t c = 0; c < 3; ++c) append(bytes, kSquare[i + c]);
  }
  const int view = builder.add_view(bytes, 16);
  const int position = builder.add("accessors", {{"bufferView", view},
                                                 {"byteOffset", 4},
                                                 {"componentType", kFloat},
                                                 {"count", 4},
                                                 {"type", "VEC3"}});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
  expect_same_triangles(world_triangles(builder.load()), plain_square());
}

/// Makes `accessor` sparse: the i-th triple of `values` replaces the element `indices[i]`.
void make_sparse(GltfBuilder& builder, int accessor, const std::vector<std::uint16_t>& indices,
                 const std::vector<float>& values) {
  const int index_view = builder.add_view(pack(indices));
  const int value_view = builder.add_view(pack(values));
  builder.doc["accessors"][accessor]["sparse"] = {
      {"count", indices.size()},
      {"indices", {{"bufferView", index_view}, {"componentType", kUint16}}},
      {"values", {{"bufferView", value_view}}}};
}

TEST(GltfGeometry, SparseValuesReplaceThoseOfTheBufferView) {
  GltfBuilder builder;
  auto wrong = kSquare;
  wrong[3] = 99;
  wrong[10] = 99;
  const int position = builder.add_positions(wrong);
  make_sparse(builder, position, {1, 3}, {2, 0, 0, 0, 1, 0});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
  expect_same_triangles(world_triangles(builder.load()), plain_square());
}

// A stride belongs to the buffer view, whose values it separates; those that replace them have
// none.
TEST(GltfGeometry, SparseValuesHaveNoStrideWhereTheBufferViewHasOne) {
  GltfBuilder builder;
  Bytes bytes;
  for (std::size_t i = 0; i < kSquare.size(); ++i) {
    append(bytes, kSquare[i] + (i == 3 || i == 10 ? 99.0f : 0.0f));
    if (i % 3 == 2) append(bytes, -7.0f);  // another attribute
  }
  const int position = builder.add("accessors", {{"bufferView", builder.add_view(bytes, 16)},
                                                 {"componentType", kFloat},
                                                 {"count", 4},
                                                 {"type", "VEC3"}});
  make_sparse(builder, position, {1, 3}, {2, 0, 0, 0, 1, 0});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
  expect_same_triangles(world_triangles(builder.load()), plain_square());
}

TEST(GltfGeometry, SparseValuesWithoutABufferViewReplaceZeros) {
  GltfBuilder builder;
  const int position =
      builder.add("accessors", {{"componentType", kFloat}, {"count", 4}, {"type", "VEC3"}});
  make_sparse(builder, position, {1, 2, 3}, {2, 0, 0, 2, 1, 0, 0, 1, 0});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}});
  expect_same_triangles(world_triangles(builder.load()), plain_square());
}

TEST(GltfGeometry, SparseIndicesWithoutABufferViewAreReadToo) {
  GltfBuilder builder;
  const int indices =
      builder.add("accessors", {{"componentType", kUint16}, {"count", 3}, {"type", "SCALAR"}});
  const int at = builder.add_view(pack<std::uint8_t>({1, 2}));
  const int values = builder.add_view(pack<std::uint16_t>({1, 2}));
  builder.doc["accessors"][indices]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", at}, {"componentType", kUint8}}},
      {"values", {{"bufferView", values}}}};
  builder.add_mesh(
      {{"attributes", {{"POSITION", builder.add_positions(kSquare)}}}, {"indices", indices}});
  EXPECT_EQ(world_triangles(builder.load()), std::vector<Triangle>{plain_square()[0]});
}

TEST(GltfGeometry, QuantizedPositionsKeepTheirValueOrBecomeFractions) {
  const auto load = [](auto values, int component, bool normalized) {
    GltfBuilder builder;
    builder.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
    // The extension requires strides that are multiples of 4 bytes.
    const int stride = component == kInt8 || component == kUint8 ? 4 : 8;
    json accessor = {{"bufferView", builder.add_view(pack(values), stride)},
                     {"componentType", component},
                     {"count", 3},
                     {"type", "VEC3"},
                     {"normalized", normalized}};
    const int position = builder.add("accessors", accessor);
    builder.add_mesh({{"attributes", {{"POSITION", position}}}});
    return world_triangles(builder.load()).at(0);
  };
  const Triangle plain = {V3f(0, 0, 0), V3f(100, -100, 0), V3f(0, 50, 7)};
  EXPECT_EQ(load(std::vector<std::int8_t>{0, 0, 0, 0, 100, -100, 0, 0, 0, 50, 7, 0}, kInt8, false),
            plain);
  EXPECT_EQ(
      load(std::vector<std::int16_t>{0, 0, 0, 0, 100, -100, 0, 0, 0, 50, 7, 0}, kInt16, false),
      plain);
  // Section 3.11: c / 127, and -128 clamped to -1.
  const Triangle unit = {V3f(1, -1, 0), V3f(-1, 0, 0), V3f(0, 1, 0)};
  EXPECT_EQ(
      load(std::vector<std::int8_t>{127, -128, 0, 0, -127, 0, 0, 0, 0, 127, 0, 0}, kInt8, true),
      unit);
  EXPECT_EQ(load(std::vector<std::int16_t>{32767, -32768, 0, 0, -32767, 0, 0, 0, 0, 32767, 0, 0},
                 kInt16, true),
            unit);
  const Triangle positive = {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)};
  EXPECT_EQ(load(std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0}, kUint8, true),
            positive);
  EXPECT_EQ(load(std::vector<std::uint16_t>{65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0},
                 kUint16, true),
            positive);
}

TEST(GltfGeometry, PrimitivesOfOneMeshAreConcatenatedWithTheirOwnMaterials) {
  GltfBuilder builder;
  const int position = builder.add_positions(kSquare);
  const int first = builder.add_accessor(std::vector<std::uint8_t>{0, 1, 2}, kUint8, "SCALAR");
  const int second = builder.add_accessor(std::vector<std::uint8_t>{0, 2, 3}, kUint8, "SCALAR");
  builder.add("materials", {{"name", "leaf"}});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", first}});
  builder.doc["meshes"][0]["name"] = "card";
  builder.doc["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", position}}}, {"indices", second}, {"material", 0}});
  const Scene scene = builder.load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].name, "card");
  EXPECT_EQ(world_triangles(scene), plain_square());
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.materials[0].name, "leaf");
  EXPECT_EQ(scene.materials[1].name, "default");
  EXPECT_EQ(scene.meshes[0].materials, (std::vector<std::uint32_t>{1, 0}));
  // Each primitive uses three of the four shared vertices, and only those are read.
  EXPECT_EQ(scene.meshes[0].positions.size(), 6u);
}

TEST(GltfGeometry, GpuInstancesAreComposedWithTheirNode) {
  GltfBuilder builder;
  const int node = builder.add_triangle();
  builder.doc["nodes"][node]["translation"] = {10, 0, 0};
  const int translation = builder.add_positions({0, 0, 0, 0, 5, 0});
  const int scale = builder.add_positions({1, 1, 1, 2, 2, 2});
  // No rotation, and a half turn about Z.
  const int rotation = builder.add_accessor(
      std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}, kInt16, "VEC4", true);
  builder.doc["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", translation}, {"ROTATION", rotation}, {"SCALE", scale}};
  builder.doc["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = builder.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  const auto triangles = world_triangles(scene);
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[0], (Triangle{V3f(10, 0, 0), V3f(11, 0, 0), V3f(10, 1, 0)}));
  EXPECT_EQ(triangles[1], (Triangle{V3f(10, 5, 0), V3f(8, 5, 0), V3f(10, 3, 0)}));
}

TEST(GltfGeometry, NonFiniteVerticesAreKeptForTheMergeToDrop) {
  GltfBuilder builder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  builder.add_mesh(
      {{"attributes", {{"POSITION", builder.add_positions({0, 0, 0, nan, 0, 0, 0, 1, 0})}}}});
  EXPECT_EQ(world_triangles(builder.load()).size(), 1u);
}

TEST(GltfGeometry, SkippedFeaturesGiveOneWarningEach) {
  GltfBuilder builder;
  const int node = builder.add_triangle();
  const int position = builder.add_positions(kSquare);
  builder.doc["skins"] = {{{"joints", {0}}}};
  builder.doc["nodes"][node]["skin"] = 0;
  builder.doc["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 1}});
  builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"mode", 0}});
  const Scene scene = builder.load();
  EXPECT_EQ(world_triangles(scene).size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 3u);
  expect_says(scene.warnings[0], "line primitives are ignored: --line-radius R makes strands");
  expect_says(scene.warnings[1], "point primitives are ignored (1");
  expect_says(scene.warnings[2], "skinned nodes have meshes without JOINTS_0 and WEIGHTS_0");
}

TEST(GltfGeometry, ASharedMeshIsReadOnceAndPlacedTwice) {
  GltfBuilder builder;
  builder.add_triangle();
  builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 3}}});
  const Scene scene = builder.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(world_triangles(scene)[1][0], V3f(0, 0, 3));
}

}  // namespace
}  // namespace dapple::test
