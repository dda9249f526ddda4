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

  /// Bakes the file; returns the mean of the bent normals of its first mesh along x.
  [[nodiscard]] float bent_x(const GltfBuilder& builder) const {
    write("in.glb", builder.glb());
    const Outcome run =
        dapple("bake in.glb -o out.glb --channel _AO --passes ao,bent --sides front --rays 4096");
    EXPECT_EQ(run.code, 0) << run.err;
    const GltfData file(path("out.glb"));
    const json& attributes = file.doc["meshes"][0]["primitives"][0]["attributes"];
    const std::vector<float> xyz = file.floats(attributes["_BENT_NORMAL"]);
    float sum = 0;
    for (std::size_t i = 0; i < xyz.size(); i += 3) sum += xyz[i];
    return 3 * sum / static_cast<float>(xyz.size());
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

/// A small square at the origin that faces up, beside a wall at x = 1.1. Its node has a skin of one
/// joint, which stands at the origin; the square follows it if it is `bound`.
GltfBuilder square_beside_a_wall(bool bound) {
  GltfBuilder builder;
  const std::vector<std::uint16_t> corners{0, 1, 2, 0, 2, 3};
  const int indices = builder.add_accessor(corners, test::kUint16, "SCALAR");
  const float s = 0.01f;
  json attributes = {{"POSITION", builder.add_positions({-s, 0, -s, -s, 0, s, s, 0, s, s, 0, -s})}};
  if (bound) {
    std::vector<float> weights(16);
    for (std::size_t v = 0; v < 4; ++v) weights[4 * v] = 1;
    attributes["JOINTS_0"] =
        builder.add_accessor(std::vector<std::uint8_t>(16), test::kUint8, "VEC4");
    attributes["WEIGHTS_0"] = builder.add_accessor(weights, test::kFloat, "VEC4");
  }
  builder.add_mesh({{"attributes", attributes}, {"indices", indices}});
  const int wall =
      builder.add_positions({1.1f, -99, -99, 1.1f, -99, 99, 1.1f, 99, 99, 1.1f, 99, -99});
  builder.add_mesh({{"attributes", {{"POSITION", wall}}}, {"indices", indices}});
  builder.doc["nodes"][0]["skin"] = 0;
  builder.add("skins", {{"joints", {builder.add("nodes", {{"name", "joint"}})}}});
  return builder;
}

// The wall hides all directions with x > 0 in the world but for one part in 10^4. Of the others the
// cosine-weighted mean is (-2/3, pi/3) along x and up, whose unit vector has x = -2 / sqrt(4 +
// pi^2). Four vertices with 4096 rays each err by less than 0.01. Squares that are mirrored along x
// have the opposite sign in object space.
constexpr float kBentX = 0.537f, kTolerance = 0.03f;

TEST_F(BakeSkins, BentNormalsOfRigidMeshesOfMirroredSkinsAreNotMirrored) {
  GltfBuilder builder = square_beside_a_wall(false);
  builder.doc["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_NEAR(bent_x(builder), kBentX, kTolerance);
}

TEST_F(BakeSkins, BentNormalsOfMirroredInstancesAreNotMirroredAsThoseOfMirroredNodesAre) {
  GltfBuilder of_node = square_beside_a_wall(true), of_instance = of_node;
  of_node.doc["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_NEAR(bent_x(of_node), -kBentX, kTolerance) << "a skin ignores its node's place";
  const int scale = of_instance.add_accessor(std::vector<float>{-1, 1, 1}, test::kFloat, "VEC3");
  of_instance.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"SCALE", scale}};
  of_instance.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  EXPECT_NEAR(bent_x(of_instance), kBentX, kTolerance);
}

}  // namespace
}  // namespace dapple
