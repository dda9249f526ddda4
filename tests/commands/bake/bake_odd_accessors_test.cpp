// Bakes of files with accessors that renders hardly meet: matrices, types that attributes cannot
// have, and a binary chunk that no buffer uses.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "scene/gltf/document/accessor.hpp"
#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

json& attributes_of(GltfBuilder& builder) {
  return builder.doc["meshes"][0]["primitives"][0]["attributes"];
}

TEST_F(BakeCommand, TypesThatColoursAndCoordinatesCannotHaveAreRefused) {
  for (const std::size_t components : {1, 2}) {
    GltfBuilder builder = rich_triangle();
    attributes_of(builder)["COLOR_0"] =
        builder.add_accessor(std::vector<float>(3 * components, 0.5f), test::kFloat,
                             components == 1 ? "SCALAR" : "VEC2");
    write("in.glb", builder.glb());
    expect_failure(dapple("bake in.glb -o out.glb"), 3, "mesh 0 primitive 0 COLOR_0 is accessor ");
  }
  GltfBuilder builder = rich_triangle();
  attributes_of(builder)["TEXCOORD_0"] =
      builder.add_accessor(std::vector<float>{0, 0.5f, 1}, test::kFloat, "SCALAR");
  write("in.glb", builder.glb());
  for (const char* to : {"--channel TEXCOORD_0.x", "--to texture"})
    expect_failure(dapple(std::string("bake in.glb -o out.glb ") + to), 3,
                   "mesh 0 primitive 0 TEXCOORD_0 is accessor ");
  EXPECT_EQ(files_in_folder(), 1u);
}

// Columns of matrices begin at multiples of four bytes.
TEST_F(BakeCommand, MatricesOfBytesAreCopiedWhole) {
  GltfBuilder builder = rich_triangle();
  test::Bytes bytes;
  for (std::uint8_t vertex = 0; vertex < 3; ++vertex)
    for (std::uint8_t column = 0; column < 3; ++column)
      for (std::uint8_t row = 0; row < 4; ++row)
        bytes.push_back(row < 3 ? static_cast<std::uint8_t>(9 * vertex + 3 * column + row) : 0);
  attributes_of(builder)["_TENSOR"] =
      builder.add("accessors", {{"bufferView", builder.add_view(bytes, 12)},
                                {"componentType", test::kUint8},
                                {"count", 3},
                                {"type", "MAT3"}});
  write("in.glb", builder.glb());
  ASSERT_EQ(dapple("bake in.glb -o out.glb --to texture --size 16 --uv own --rays 8").code, 0);
  const gltf::Document document = gltf::load_document(path("out.glb"), false);
  const auto& attributes = document.model.meshes[0].primitives[0].attributes;
  const gltf::AccessorReader tensors(document, attributes.at("_TENSOR"));
  ASSERT_EQ(tensors.count(), 3u);
  for (std::size_t i = 0; i < 27; ++i)
    EXPECT_EQ(tensors.stored(i / 9, i % 9), static_cast<float>(i)) << i;
}

// The triangle of the vertex is dropped; the vertex stays.
TEST_F(BakeCommand, AVertexAtInfinityLeavesBoundsThatAreNumbers) {
  GltfBuilder builder = rich_triangle();
  const int position = builder.add_accessor(
      std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, std::numeric_limits<float>::infinity(), 0, 0},
      test::kFloat, "VEC3");
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", position}};
  primitive["indices"] =
      builder.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 1, 3}, test::kUint16, "SCALAR");
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to texture --size 16 --rays 8");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(load_gltf(path("out.glb")).meshes.at(0).primitive_count(), 2u) << "it is read";
  for (const char* file : {"in.glb", "out.glb"}) std::filesystem::remove(path(file));
}

TEST_F(BakeCommand, VerticesThatAreAllAtInfinityLeaveBoundsThatAreNumbers) {
  GltfBuilder builder = rich_triangle();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  json& primitives = builder.doc["meshes"][0]["primitives"];
  primitives.push_back(
      {{"attributes",
        {{"POSITION", builder.add_accessor(
                          std::vector<float>{kInfinity, 0, 0, kInfinity, 1, 0, kInfinity, 0, 1},
                          test::kFloat, "VEC3")}}}});
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --to texture --size 16 --rays 8");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_FALSE(load_gltf(path("out.glb")).meshes.empty()) << "it is read";
  for (const char* file : {"in.glb", "out.glb"}) std::filesystem::remove(path(file));
}

TEST_F(BakeCommand, ABinaryChunkThatNoBufferUsesIsLeftOut) {
  GltfBuilder builder = rich_triangle();
  write("far.bin", builder.bin);
  builder.doc["buffers"] = json::array({{{"byteLength", builder.bin.size()}, {"uri", "far.bin"}}});
  builder.bin = {1, 2, 3, 4};
  write("in.glb", builder.glb());
  for (const char* output : {"out.gltf", "out.glb"}) {
    const Outcome run = dapple(std::string("bake in.glb -o ") + output);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(load_gltf(path(output)).meshes.at(0).primitive_count(), 1u) << output;
  }
}

}  // namespace
}  // namespace dapple
