// NORMAL of glTF files: read, morphed, skinned, merged; against vectors computed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

void expect_near(const V3f& a, const V3f& b) {
  EXPECT_LE((a - b).length(), 2e-6f) << a << " is not " << b;
}

/// The triangle of one_triangle() with these normals.
GltfBuilder with_normals(const std::vector<float>& xyz) {
  GltfBuilder b = one_triangle();
  b.doc["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.add_positions(xyz);
  return b;
}

TEST(GltfNormals, AreReadAsUnitVectorsAndZeroWhereTheyHaveNoDirection) {
  const float nan = std::nanf("");
  const Scene scene = with_normals({0, 0, 2, 0, 3, 4, nan, 0, 0}).load();
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.normals.size(), 3u);
  expect_near(mesh.normals[0], V3f(0, 0, 1));
  expect_near(mesh.normals[1], V3f(0, 0.6f, 0.8f));
  EXPECT_EQ(mesh.normals[2], V3f(0, 0, 0));
  EXPECT_TRUE(one_triangle().load().meshes.at(0).normals.empty());
}

TEST(GltfNormals, APrimitiveWithoutThemGetsZeros) {
  GltfBuilder b = with_normals({0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.doc["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", b.add_positions({0, 0, 1, 1, 0, 1, 0, 1, 1})}}}});
  const Mesh mesh = b.load().meshes.at(0);
  ASSERT_EQ(mesh.normals.size(), 6u);
  EXPECT_EQ(mesh.normals[4], V3f(0, 0, 0));
}

TEST(GltfNormals, MorphTargetsAddToThem) {
  GltfBuilder b = with_normals({0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.doc["meshes"][0]["primitives"][0]["targets"] = {
      {{"NORMAL", b.add_positions({0, 0, 0, 0, 2, 0, 0, 0, 0})}}};
  b.doc["meshes"][0]["weights"] = {0.5};
  const Mesh mesh = b.load().meshes.at(0);
  expect_near(mesh.normals[0], V3f(0, 0, 1));
  expect_near(mesh.normals[1], V3f(0, 1, 1).normalized());
}

// Joint 0 stands still; joint 1 turns by 90 degrees about Z and stretches by 2 along Y after that.
TEST(GltfNormals, JointsTurnThem) {
  GltfBuilder b = with_normals({0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0});
  auto& attributes = b.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] =
      b.add_accessor<std::uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 5121, "VEC4");
  attributes["WEIGHTS_0"] =
      b.add_accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0}, 5126, "VEC4");
  const int still = b.add("nodes", json::object());
  const float half = std::sqrt(0.5f);
  const int turned = b.add("nodes", {{"rotation", {0, 0, half, half}}});
  const int stretched = b.add("nodes", {{"scale", {1, 2, 1}}, {"children", {turned}}});
  (void)stretched;
  b.add("skins", {{"joints", {still, turned}}});
  b.doc["nodes"][0]["skin"] = 0;
  const Mesh mesh = b.load().meshes.at(0);
  expect_near(mesh.normals.at(0), V3f(0.6f, 0.8f, 0));
  // (0.6, 0.8) turned is (-0.8, 0.6); a plane that is stretched by 2 along Y has half of that y.
  expect_near(mesh.normals.at(1), V3f(-0.8f, 0.3f, 0).normalized());
}

TEST(GltfNormals, MergedMeshesHaveThemInWorldSpace) {
  GltfBuilder b = with_normals({0, 0.6f, 0.8f, 0, 0, 1, 0, 0, 1});
  b.doc["nodes"][0]["scale"] = {1, 1, 4};
  b.add_triangle();
  Scene scene = b.load();
  merge_single_instances(scene);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.normals.size(), 6u);
  V3f first(0, 0, 0);
  int zeros = 0;
  for (std::size_t v = 0; v < 6; ++v) {
    zeros += mesh.normals[v] == V3f(0, 0, 0);
    if (mesh.positions[v] == V3f(0, 0, 0) && mesh.normals[v] != V3f(0, 0, 0))
      first = mesh.normals[v];
  }
  EXPECT_EQ(zeros, 3) << "those of the triangle without normals";
  expect_near(first, V3f(0, 0.6f, 0.2f).normalized());
}

TEST(GltfNormals, ATypeThatGltfDoesNotAllowIsRefused) {
  GltfBuilder b = one_triangle();
  b.doc["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      b.add_accessor<std::uint16_t>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 5123, "VEC3");
  expect_says(error_of(b), "NORMAL");
}

}  // namespace
}  // namespace dapple::test
