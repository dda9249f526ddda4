// Bakes of files whose primitives or meshes share vertices: what a vertex gets is of those that use
// it, and meshes that use the same vertices have values of their own.
#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "support/programs/bake_command.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;

/// Accessors of `attribute` in the first primitives of the first two meshes.
std::array<json, 2> accessors_of_two(const json& doc, const char* attribute) {
  std::array<json, 2> found;
  for (std::size_t m = 0; m < 2; ++m)
    found[m] = doc["meshes"][m]["primitives"][0]["attributes"].at(attribute);
  return found;
}

TEST_F(BakeCommand, MeshesThatShareVerticesHaveValuesOfTheirOwn) {
  GltfBuilder builder = rich_triangle();
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.doc["nodes"].push_back(
      {{"mesh", 1}, {"scale", {9, 9, 9}}, {"translation", {-2, -2, 0.1}}});
  builder.doc.erase("scenes");
  builder.add("scenes", {{"nodes", {0, 1}}});
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --sides front --rays 1024");
  ASSERT_EQ(run.code, 0) << run.err;
  // The larger one hides almost all from the other one's front, and nothing hides its own.
  const test::GltfData file(path("out.glb"));
  const auto [below, above] = accessors_of_two(file.doc, "_AO");
  for (const float ao : file.floats(below)) EXPECT_LT(ao, 0.1f);
  for (const float ao : file.floats(above)) EXPECT_GT(ao, 0.99f);
}

TEST_F(BakeCommand, NormalsOfSheetsThatAreBrighterFromBehindStayInFront) {
  GltfBuilder builder = rich_triangle();
  builder.add("materials", {{"doubleSided", true}});
  builder.doc["meshes"][0]["primitives"][0]["material"] = 0;
  builder.doc["nodes"].push_back(
      {{"mesh", 0}, {"scale", {9, 9, 9}}, {"translation", {-2, -2, 0.1}}});
  builder.doc.erase("scenes");
  builder.add("scenes", {{"nodes", {0, 1}}});
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  builder.doc["nodes"][1]["mesh"] = 1;
  write("in.glb", builder.glb());
  for (const char* channel : {"NORMAL", "_BENT_NORMAL"}) {
    const Outcome run = dapple(std::string("bake in.glb -o out.glb --passes ao,bent ") +
                               "--channel _AO --bent-channel " + channel);
    ASSERT_EQ(run.code, 0) << run.err;
    const test::GltfData file(path("out.glb"));
    const std::vector<float> bent = file.floats(accessors_of_two(file.doc, channel)[0]);
    EXPECT_EQ(bent[2] > 0, channel == std::string("NORMAL")) << bent[2];
  }
}

// As files have them whose positions were deduplicated.
TEST_F(BakeCommand, MeshesOfOnePositionAccessorWithOwnColorsHaveValuesOfTheirOwn) {
  GltfBuilder builder = rich_triangle();
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  for (std::size_t mesh = 0; mesh < 2; ++mesh)
    builder.doc["meshes"][mesh]["primitives"][0]["attributes"]["COLOR_0"] =
        builder.add_accessor(std::vector<float>(9, 1.0f), test::kFloat, "VEC3");
  builder.doc["nodes"].push_back(
      {{"mesh", 1}, {"scale", {9, 9, 9}}, {"translation", {-2, -2, 0.1}}});
  builder.doc.erase("scenes");
  builder.add("scenes", {{"nodes", {0, 1}}});
  write("in.glb", builder.glb());
  std::ofstream(path("sun.json")) << R"({"lights": [{"type": "sun", "name": "sun",
      "direction": [0, 0, -1], "irradiance": 1}]})";
  const Outcome run = dapple(
      "bake in.glb -o out.glb --passes ao,bent,light --lights sun.json --sides front --rays 1024");
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData file(path("out.glb"));
  const auto [below, above] = accessors_of_two(file.doc, "_LIGHT_sun");
  for (const float light : file.floats(below)) EXPECT_LT(light, 0.1f);
  for (const float light : file.floats(above)) EXPECT_GT(light, 0.9f);
  EXPECT_NE(accessors_of_two(file.doc, "_BENT_NORMAL")[0],
            accessors_of_two(file.doc, "_BENT_NORMAL")[1]);
}

TEST_F(BakeCommand, MeshesThatUseOtherVerticesOfOneBufferShareTheirValues) {
  GltfBuilder builder = rich_triangle();
  json& attributes = builder.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes = {{"POSITION", builder.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1,
                                                                     1, 0, 1, 0, 0, 0, 1, 0},
                                                  test::kFloat, "VEC3")}};
  builder.doc["accessors"].back()["min"] = {0, 0, 0};
  builder.doc["accessors"].back()["max"] = {1, 1, 0};
  builder.doc["meshes"].push_back(builder.doc["meshes"][0]);
  const auto use = [&](std::size_t mesh, const std::vector<std::uint16_t>& vertices) {
    builder.doc["meshes"][mesh]["primitives"][0]["indices"] =
        builder.add_accessor(vertices, test::kUint16, "SCALAR");
  };
  for (const bool disjoint : {true, false}) {
    use(0, {0, 1, 2});
    use(1, disjoint ? std::vector<std::uint16_t>{3, 5, 4} : std::vector<std::uint16_t>{3, 2, 4});
    // The vertex that both may use lies below the first one's front in the second.
    builder.doc["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}, {"translation", {0.3, -0.7, -0.01}}}};
    builder.doc["scenes"] = {{{"nodes", {0, 1}}}};
    write("in.glb", builder.glb());
    const Outcome run = dapple("bake in.glb -o out.glb --channel _AO");
    ASSERT_EQ(run.code, 0) << run.err;
    const auto [first, second] = accessors_of_two(document("out.glb"), "_AO");
    EXPECT_EQ(first == second, disjoint);
  }
}

// Poses of a mesh are means of equal values: in the open these stay 1, to the bit.
TEST_F(BakeCommand, MeansOfManyPosesInTheOpenAreOne) {
  GltfBuilder builder = rich_triangle();
  json& primitive = builder.doc["meshes"][0]["primitives"][0];
  const int shift = builder.add_positions({0, 0, 0, 0.1f, 0, 0, 0, 0.1f, 0});
  builder.doc["accessors"][shift]["min"] = {0, 0, 0};
  builder.doc["accessors"][shift]["max"] = {0.1f, 0.1f, 0};
  primitive["targets"] = {{{"POSITION", shift}}};
  builder.doc["nodes"] = json::array();
  json nodes = json::array();
  for (int i = 0; i < 11; ++i) {
    nodes.push_back(i);
    builder.add("nodes", {{"mesh", 0}, {"translation", {9 * i, 0, 0}}, {"weights", {0.05 * i}}});
  }
  builder.doc["scenes"] = {{{"nodes", nodes}}};
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --rays 8");
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData file(path("out.glb"));
  const json& color = file.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
  EXPECT_EQ(file.accessor(color)["componentType"], test::kUint16);
  ASSERT_EQ(file.floats(color).size(), 9u);
  for (const float value : file.floats(color)) EXPECT_EQ(value, 1);
}

// A sheet that faces up, and down to a floor: each side has a primitive, and both the same
// vertices.
TEST_F(BakeCommand, SidesOfASheetThatShareVerticesHaveValuesOfTheirOwn) {
  GltfBuilder builder = rich_triangle();
  const int position = builder.add_accessor(
      std::vector<float>{0, 0.3f, 0, 1, 0.3f, 0, 1, 0.3f, 1, 0, 0.3f, 1}, test::kFloat, "VEC3");
  builder.doc["accessors"][position]["min"] = {0, 0.3f, 0};
  builder.doc["accessors"][position]["max"] = {1, 0.3f, 1};
  json primitives = json::array();
  for (const std::vector<std::uint16_t>& indices :
       {std::vector<std::uint16_t>{0, 2, 1, 0, 3, 2}, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}})
    primitives.push_back({{"attributes", {{"POSITION", position}}},
                          {"indices", builder.add_accessor(indices, test::kUint16, "SCALAR")}});
  builder.doc["meshes"][0]["primitives"] = primitives;
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --ground --rays 1024");
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData file(path("out.glb"));
  const json& sides = file.doc["meshes"][0]["primitives"];
  const std::vector<float> up = file.floats(sides[0]["attributes"]["_AO"]),
                           down = file.floats(sides[1]["attributes"]["_AO"]);
  ASSERT_EQ(up.size(), 4u);
  ASSERT_EQ(down.size(), 4u);
  for (const float ao : up) EXPECT_GT(ao, 0.99f);
  for (const float ao : down) EXPECT_LT(ao, 0.1f);
}

// The second primitive has more indices than there are vertices, and does not use those of the
// first.
TEST_F(BakeCommand, AVertexHasNoPartOfPrimitivesThatDoNotUseIt) {
  GltfBuilder builder = rich_triangle();
  const std::vector<float> positions{
      0,  0,  0, 1, 0,  0, 0,  1, 0, 1, 1, 0,  // and a sheet above it
      -9, -9, 1, 9, -9, 1, -9, 9, 1, 9, 9, 1};
  const std::size_t position = builder.add_accessor(positions, test::kFloat, "VEC3");
  builder.doc["accessors"].back()["min"] = {-9, -9, 0};
  builder.doc["accessors"].back()["max"] = {9, 9, 1};
  json& primitives = builder.doc["meshes"][0]["primitives"];
  primitives = json::array();
  for (const std::vector<std::uint16_t>& indices :
       {std::vector<std::uint16_t>{0, 1, 2, 1, 3, 2},
        std::vector<std::uint16_t>{4, 5, 6, 5, 7, 6, 4, 6, 5}})
    primitives.push_back({{"attributes", {{"POSITION", position}}},
                          {"indices", builder.add_accessor(indices, test::kUint16, "SCALAR")}});
  write("in.glb", builder.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --channel _AO --sides front");
  ASSERT_EQ(run.code, 0) << run.err;
  const test::GltfData file(path("out.glb"));
  const json& attributes = file.doc["meshes"][0]["primitives"][0]["attributes"];
  const std::vector<float> ao = file.floats(attributes["_AO"]);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_LT(ao[v], 0.1f) << v;  // the sheet hides nearly all
  for (std::size_t v = 4; v < 8; ++v) EXPECT_GT(ao[v], 0.9f) << v;
}

}  // namespace
}  // namespace dapple
