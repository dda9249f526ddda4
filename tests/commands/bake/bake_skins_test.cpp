// A skinned and animated mesh keeps its skins, joints, weights and animations in all bakes, also
// where vertices are duplicated on the border of charts, and moves as before.
#include <gtest/gtest.h>

#include "dapple/moving_scene.hpp"
#include "support/programs/bake_command.hpp"
#include "support/scenes/reed.hpp"

namespace dapple {
namespace {

using namespace film_test;
using namespace program_test;
using test::GltfData;

const std::vector<const char*> kAttributes = {"POSITION", "NORMAL", "TEXCOORD_0", "JOINTS_0",
                                              "WEIGHTS_0"};

/// The numbers of kAttributes at each corner of the triangles that a node shows.
std::vector<std::vector<double>> corners_of(const GltfData& file, const json& node) {
  std::vector<std::vector<double>> corners;
  for (const json& primitive : file.doc["meshes"][node["mesh"].get<std::size_t>()]["primitives"]) {
    std::vector<std::vector<double>> of_attribute;
    for (const char* name : kAttributes)
      of_attribute.push_back(file.stored(primitive["attributes"].at(name)));
    const std::size_t count = file.accessor(primitive["attributes"]["POSITION"])["count"];
    for (const double index : file.stored(primitive["indices"])) {
      std::vector<double>& corner = corners.emplace_back();
      for (const std::vector<double>& values : of_attribute) {
        const std::size_t n = values.size() / count;
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(n * std::size_t(index));
        corner.insert(corner.end(), first, first + static_cast<std::ptrdiff_t>(n));
      }
    }
  }
  return corners;
}

/// How the accessors of a primitive's attributes store their numbers.
json formats_of(const GltfData& file, const json& node) {
  const json& primitive = file.doc["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
  json formats;
  for (const char* name : kAttributes) {
    const json& a = file.accessor(primitive["attributes"][name]);
    formats[name] = {a["componentType"], a["type"], a.value("normalized", false)};
  }
  return formats;
}

/// `elements` with the numbers of accessors in place of their indices.
json with_numbers(const GltfData& file, json elements) {
  for (json& element : elements)
    for (const char* key : {"inverseBindMatrices", "input", "output"})
      if (element.contains(key)) element[key] = file.stored(element[key]);
  return elements;
}

class BakeSkins : public BakeCommand {
 protected:
  BakeSkins() { write("in.glb", test::Reed().file.glb()); }

  void bake(const std::string& options) const {
    const Outcome run = dapple("bake in.glb -o out.glb --rays 8 -q " + options);
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
  }

  /// Skins, animations, and the node of each name with its skin and what it shows.
  void expect_all_kept() const {
    const GltfData before(path("in.glb")), after(path("out.glb"));
    ASSERT_EQ(before.doc["skins"].size(), 2u);
    EXPECT_EQ(with_numbers(after, after.doc["skins"]), with_numbers(before, before.doc["skins"]));
    ASSERT_EQ(after.doc["animations"].size(), 1u);
    const json &is = after.doc["animations"][0], &was = before.doc["animations"][0];
    EXPECT_EQ(is["name"], was["name"]);
    EXPECT_EQ(is["channels"], was["channels"]);
    EXPECT_EQ(with_numbers(after, is["samplers"]), with_numbers(before, was["samplers"]));
    EXPECT_EQ(after.doc["scenes"], before.doc["scenes"]);
    ASSERT_EQ(after.doc["nodes"].size(), before.doc["nodes"].size());
    for (std::size_t i = 0; i < before.doc["nodes"].size(); ++i) {
      SCOPED_TRACE(i);
      json old_node = before.doc["nodes"][i], new_node = after.doc["nodes"][i];
      if (old_node.contains("mesh")) {
        EXPECT_EQ(corners_of(after, new_node), corners_of(before, old_node));
        EXPECT_EQ(formats_of(after, new_node), formats_of(before, old_node));
        EXPECT_EQ(color_texture(after, new_node), color_texture(before, old_node));
      }
      for (const char* key : {"mesh", "extras"}) {
        new_node.erase(key);
        old_node.erase(key);
      }
      EXPECT_EQ(new_node, old_node) << "name, skin, children and place";
    }
    expect_same_motion();
  }

  /// dapple's own reader sees the same triangles at moments of the animation.
  void expect_same_motion() const {
    const MovingScene before(path("in.glb")), after(path("out.glb"));
    std::vector<std::vector<test::Triangle>> moments;
    for (const double time : {0.0, 0.4, 1.5}) {
      moments.push_back(test::world_triangles(before.at(time)));
      EXPECT_TRUE(test::world_triangles(after.at(time)) == moments.back()) << time;
    }
    EXPECT_FALSE(moments[0] == moments[1]);
    EXPECT_FALSE(moments[1] == moments[2]);
  }

  static json color_texture(const GltfData& file, const json& node) {
    const json& primitive = file.doc["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
    const json& material = file.doc["materials"][primitive["material"].get<std::size_t>()];
    const json& texture = material["pbrMetallicRoughness"]["baseColorTexture"];
    return {texture, file.doc["textures"][texture["index"].get<std::size_t>()]};
  }

  /// Of the mesh that node number `node` of out.glb shows.
  [[nodiscard]] json primitive_of(std::size_t node) const {
    const json doc = document("out.glb");
    return doc["meshes"][doc["nodes"][node]["mesh"].get<std::size_t>()]["primitives"][0];
  }
  [[nodiscard]] std::size_t vertices_of(const std::string& name) const {
    const GltfData file(path(name));
    return file.accessor(file.doc["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"])["count"];
  }
};

/// The nodes of test::Reed with the mesh.
constexpr std::size_t kFirst = 3, kSecond = 7;

TEST_F(BakeSkins, AtVerticesAreKept) {
  bake("");
  expect_all_kept();
  EXPECT_TRUE(primitive_of(kFirst)["attributes"].contains("COLOR_0"));
  EXPECT_EQ(vertices_of("out.glb"), vertices_of("in.glb"));
}

// A skin ignores the place of its node, so that its instances cannot become nodes.
TEST_F(BakeSkins, WithInstancesKeepTheseWhereOthersBecomeUnique) {
  test::Reed reed;
  const int places =
      reed.file.add_accessor(std::vector<float>{3, 0, 0, 6, 0, 0}, test::kFloat, "VEC3");
  reed.file.doc["nodes"][kFirst]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}};
  reed.file.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  write("in.glb", reed.file.glb());
  const Outcome run = dapple("bake in.glb -o out.glb --rays 8 --instances unique");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(contains(run.err, "skinned meshes with EXT_mesh_gpu_instancing keep it")) << run.err;
  EXPECT_TRUE(test::world_triangles(load_gltf(path("out.glb"))) ==
              test::world_triangles(load_gltf(path("in.glb"))));
  const json nodes = document("out.glb")["nodes"];
  EXPECT_NE(nodes[kFirst]["mesh"], nodes[kSecond]["mesh"]) << "the other node has its own";
  EXPECT_TRUE(primitive_of(kFirst)["attributes"].contains("COLOR_0"));
}

TEST_F(BakeSkins, InATextureAreKeptByDuplicatedVertices) {
  bake("--to texture --size 64 --margin 2");
  expect_all_kept();
  EXPECT_TRUE(primitive_of(kFirst)["attributes"].contains("TEXCOORD_1"));
  EXPECT_GT(vertices_of("out.glb"), vertices_of("in.glb"));
}

TEST_F(BakeSkins, OfInstancesAreKept) {
  bake("--to instance");
  expect_all_kept();
  for (const std::size_t node : {kFirst, kSecond})
    EXPECT_TRUE(document("out.glb")["nodes"][node]["extras"].contains("ao")) << node;
}

TEST_F(BakeSkins, OfUniqueMeshesAreKept) {
  for (const char* to : {"vertex --channel _AO", "texture --size 64 --margin 2"}) {
    SCOPED_TRACE(to);
    bake("--instances unique --to " + std::string(to));
    expect_all_kept();
    const json doc = document("out.glb");
    EXPECT_NE(doc["nodes"][kFirst]["mesh"], doc["nodes"][kSecond]["mesh"]);
  }
}

}  // namespace
}  // namespace dapple
