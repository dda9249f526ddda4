// Morph targets and skins of glTF files, at rest and animated: positions of vertices against values
// computed by hand, and which files are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "dapple/moving_scene.hpp"
#include "support/files/gltf_builder.hpp"

namespace dapple::test {
namespace {

const double kHalfRoot = std::sqrt(0.5);

void expect_near(V3f a, V3f b) { EXPECT_LE((a - b).length(), 2e-6f) << a << " is not " << b; }

SceneOptions at(double seconds) {
  SceneOptions options;
  options.time = seconds;
  return options;
}

V3f vertex(const Scene& scene, std::size_t i) {
  const Instance& instance = scene.instances.at(0);
  return scene.meshes[instance.mesh].positions.at(i) * instance.to_world;
}

/// One triangle with two targets: the first moves corner 1 by 4 along +Y, the second moves corner 2
/// by 8 along +Z.
GltfBuilder morphed() {
  GltfBuilder b = one_triangle();
  b.doc["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", b.add_positions({0, 0, 0, 0, 4, 0, 0, 0, 0})}},
      {{"POSITION", b.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 8})}}};
  return b;
}

TEST(GltfMorph, TargetsAddToPositionsByTheWeightsOfTheMesh) {
  GltfBuilder b = morphed();
  b.doc["meshes"][0]["weights"] = {0.5, -0.25};
  const Scene scene = b.load();
  expect_near(vertex(scene, 0), V3f(0, 0, 0));
  expect_near(vertex(scene, 1), V3f(1, 2, 0));
  expect_near(vertex(scene, 2), V3f(0, 1, -2));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfMorph, WeightsOfTheNodeComeBeforeThoseOfTheMesh) {
  GltfBuilder b = morphed();
  b.doc["meshes"][0]["weights"] = {0.5, 0};
  b.doc["nodes"][0]["weights"] = {0, 1};
  b.add("nodes", {{"mesh", 0}});
  const Scene scene = b.load();
  EXPECT_EQ(scene.meshes.size(), 2u) << "uses of different weights are different meshes";
  expect_near(vertex(scene, 1), V3f(1, 0, 0));
  expect_near(vertex(scene, 2), V3f(0, 1, 8));
  EXPECT_EQ(scene.meshes[scene.instances.at(1).mesh].positions[1], V3f(1, 2, 0));
}

TEST(GltfMorph, EqualWeightsShareAMesh) {
  GltfBuilder b = morphed();
  b.doc["nodes"][0]["weights"] = {0.5, 0.5};
  b.add("nodes", {{"mesh", 0}, {"weights", {0.5, 0.5}}});
  EXPECT_EQ(b.load().meshes.size(), 1u);
}

/// Adds a channel that animates the weights of `node`, with keyframes at 0 s and 1 s. `values` are
/// the weights of both keyframes, with tangents if the interpolation has them.
void animate_weights(GltfBuilder& b, int node, const char* interpolation,
                     const std::vector<float>& values) {
  const int times = b.add_accessor(std::vector<float>{0, 1}, kFloat, "SCALAR");
  const int output = b.add_accessor(values, kFloat, "SCALAR");
  if (!b.doc.contains("animations"))
    b.add("animations", {{"samplers", json::array()}, {"channels", json::array()}});
  json& animation = b.doc["animations"][0];
  animation["samplers"].push_back(
      {{"input", times}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1},
                                   {"target", {{"node", node}, {"path", "weights"}}}});
}

TEST(GltfMorph, AnimatedWeightsTakeThePlaceOfAllOthers) {
  GltfBuilder b = morphed();
  b.doc["nodes"][0]["weights"] = {9, 9};
  animate_weights(b, 0, "LINEAR", {0, 0, 1, 0.5f});
  const Scene half = b.load(at(0.5));
  expect_near(vertex(half, 1), V3f(1, 2, 0));
  expect_near(vertex(half, 2), V3f(0, 1, 2));
  expect_near(vertex(b.load(at(0)), 1), V3f(1, 0, 0));
}

TEST(GltfMorph, SplinesOfWeightsHaveATangentAValueAndATangentOfEveryTarget) {
  GltfBuilder b = morphed();
  animate_weights(b, 0, "CUBICSPLINE",
                  {7, 7, 0, 0, 4, 0,  // in-tangents, values, out-tangents
                   0, 8, 1, 0.5f, 7, 7});
  // Halfway: h00 = h01 = 1/2, h10 = 1/8, h11 = -1/8.
  const Scene half = b.load(at(0.5));
  expect_near(vertex(half, 1), V3f(1, 4 * (0.5f + 0.5f), 0));
  expect_near(vertex(half, 2), V3f(0, 1, 8 * (0.25f - 1.0f)));
}

TEST(GltfMorph, MeshesThatMoveStayTheirNodesEvenWhileTheyAreEqual) {
  GltfBuilder b = morphed();
  b.add("nodes", {{"mesh", 0}});
  animate_weights(b, 0, "LINEAR", {0, 0, 1, 0});
  animate_weights(b, 1, "LINEAR", {0, 0, 0, 1});
  const TempFolder folder;
  const MovingScene moving(folder.write("scene.glb", b.glb()));
  EXPECT_EQ(moving.at(0.0).meshes.size(), 2u);
  EXPECT_EQ(moving.at(1.0).meshes.size(), 2u);
}

TEST(GltfMorph, WeightsOfTheWrongNumberAreRefusedByChannel) {
  GltfBuilder b = morphed();
  animate_weights(b, 0, "LINEAR", {0, 1});
  expect_says(error_of(b), "animation 0 channel 0 has 2 keyframes of 2 values, but 2 values");
}

/// A bar of two unit squares, one above the other, in the plane z = 0: x is 0 or 1, y is 0, 1 or 2.
/// Joint 0 moves the lower vertices, joint 1 at (0, 1, 0) the upper ones, both joints the middle
/// ones. The bar's own node has another translation, which must have no effect.
struct Bar {
  GltfBuilder b;
  int mesh_node = 0, lower = 0, upper = 0;
};

Bar make_bar(const std::vector<float>& middle_weights = {0.5f, 0.5f, 0, 0}) {
  Bar bar;
  GltfBuilder& b = bar.b;
  const int position = b.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0});
  const int indices = b.add_accessor(std::vector<std::uint16_t>{0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4},
                                     kUint16, "SCALAR");
  const int joints = b.add_accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0,
                                                              0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                                    kUint8, "VEC4");
  std::vector<float> weights = {1, 0, 0, 0, 1, 0, 0, 0};
  for (int i = 0; i < 2; ++i)
    weights.insert(weights.end(), middle_weights.begin(), middle_weights.end());
  weights.insert(weights.end(), {1, 0, 0, 0, 1, 0, 0, 0});
  bar.mesh_node = b.add_mesh({{"attributes",
                               {{"POSITION", position},
                                {"JOINTS_0", joints},
                                {"WEIGHTS_0", b.add_accessor(weights, kFloat, "VEC4")}}},
                              {"indices", indices}});
  b.doc["nodes"][bar.mesh_node]["translation"] = {100, 100, 100};
  bar.upper = b.add("nodes", {{"translation", {0, 1, 0}}});
  bar.lower = b.add("nodes", {{"children", {bar.upper}}});
  const int view = b.add_view(pack<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}));
  const int inverse =
      b.add("accessors",
            {{"bufferView", view}, {"componentType", kFloat}, {"count", 2}, {"type", "MAT4"}});
  b.add("skins", {{"joints", {bar.lower, bar.upper}}, {"inverseBindMatrices", inverse}});
  b.doc["nodes"][bar.mesh_node]["skin"] = 0;
  return bar;
}

TEST(GltfSkin, InItsBindPoseAMeshIsAsItIsWrittenWhereverItsNodeIs) {
  const Scene scene = make_bar().b.load();
  EXPECT_EQ(scene.instances.at(0).to_world, M44f());
  expect_near(vertex(scene, 1), V3f(1, 0, 0));
  expect_near(vertex(scene, 3), V3f(1, 1, 0));
  expect_near(vertex(scene, 5), V3f(1, 2, 0));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfSkin, ABarIsBentByAQuarterTurnOfItsUpperJoint) {
  Bar bar = make_bar();
  // A quarter turn about Z at (0, 1, 0) takes +X to +Y, and +Y to -X.
  bar.b.doc["nodes"][bar.upper]["rotation"] = {0, 0, kHalfRoot, kHalfRoot};
  const Scene scene = bar.b.load();
  expect_near(vertex(scene, 0), V3f(0, 0, 0));
  expect_near(vertex(scene, 1), V3f(1, 0, 0));
  expect_near(vertex(scene, 4), V3f(-1, 1, 0));
  expect_near(vertex(scene, 5), V3f(-1, 2, 0));
  // The mean of (1, 1, 0) and (0, 2, 0), the positions to which the two joints move it.
  expect_near(vertex(scene, 3), V3f(0.5f, 1.5f, 0));
}

/// The normal of the bar's first triangle by its winding, in the world.
V3f face_normal(const Scene& scene) {
  const Instance& instance = scene.instances.at(0);
  const auto& indices = scene.meshes[instance.mesh].indices;
  const V3f a = vertex(scene, indices[0]), b = vertex(scene, indices[1]),
            c = vertex(scene, indices[2]);
  const V3f normal = (b - a).cross(c - a).normalized();
  return instance.to_world.determinant() < 0 ? -normal : normal;
}

TEST(GltfSkin, BelowAMirroredNodeTheFrontOfATriangleIsMirroredWithIt) {
  Bar bar = make_bar();
  const V3f front = face_normal(bar.b.load());
  bar.b.add("nodes", {{"children", {bar.mesh_node, bar.lower}}, {"scale", {1, 1, -1}}});
  const Scene mirrored = bar.b.load();
  expect_near(vertex(mirrored, 5), V3f(1, 2, 0));
  expect_near(face_normal(mirrored), V3f(front.x, front.y, -front.z));
}

TEST(GltfSkin, JointsThatAreAnimatedCarryTheMesh) {
  Bar bar = make_bar();
  const auto h = static_cast<float>(kHalfRoot);
  const int times = bar.b.add_accessor(std::vector<float>{0, 1}, kFloat, "SCALAR");
  const int rotations =
      bar.b.add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, h, h}, kFloat, "VEC4");
  bar.b.add(
      "animations",
      {{"samplers", {{{"input", times}, {"output", rotations}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", bar.upper}, {"path", "rotation"}}}}}}});
  const TempFolder folder;
  const MovingScene moving(folder.write("scene.glb", bar.b.glb()));
  expect_near(vertex(moving.at(1.0), 5), V3f(-1, 2, 0));
  expect_near(vertex(moving.at(0.5), 4), V3f(-h, 1 + h, 0));
  expect_near(vertex(moving.at({}), 5), V3f(1, 2, 0));
  EXPECT_EQ(moving.at(0.5).meshes[0].indices, moving.at(1.0).meshes[0].indices);
}

TEST(GltfSkin, WeightsCountRelativeToTheirSumAndNoneMeansTheFirstJoint) {
  for (const auto& weights : {std::vector<float>{0.25f, 0.25f, 0, 0}, {3, 3, 0, 0}}) {
    Bar bar = make_bar(weights);
    bar.b.doc["nodes"][bar.upper]["rotation"] = {0, 0, kHalfRoot, kHalfRoot};
    expect_near(vertex(bar.b.load(), 3), V3f(0.5f, 1.5f, 0));
  }
  Bar none = make_bar({0, 0, 0, 0});
  none.b.doc["nodes"][none.upper]["rotation"] = {0, 0, kHalfRoot, kHalfRoot};
  expect_near(vertex(none.b.load(), 3), V3f(1, 1, 0));
}

// Instances of a skinned mesh stand where their translation says, whatever the scale of their node.
TEST(GltfSkin, InstancesOfAMirroredNodeAreNotMirrored) {
  for (const int x : {1, -1}) {
    Bar bar = make_bar();
    bar.b.doc["nodes"][bar.mesh_node]["scale"] = {x, 1, 1};
    const int places = bar.b.add_accessor(std::vector<float>{3, 0, 0}, kFloat, "VEC3");
    bar.b.doc["nodes"][bar.mesh_node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", places}};
    bar.b.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    expect_near(vertex(bar.b.load(), 5), V3f(4, 2, 0));
  }
}

TEST(GltfSkin, WithoutInverseBindMatricesJointsCarryFromTheOrigin) {
  Bar bar = make_bar();
  bar.b.doc["skins"][0].erase("inverseBindMatrices");
  expect_near(vertex(bar.b.load(), 5), V3f(1, 3, 0));
}

TEST(GltfSkin, MorphTargetsComeBeforeJoints) {
  Bar bar = make_bar();
  bar.b.doc["meshes"][0]["primitives"][0]["targets"] = {
      {{"POSITION", bar.b.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0})}}};
  bar.b.doc["meshes"][0]["weights"] = {1};
  bar.b.doc["nodes"][bar.upper]["rotation"] = {0, 0, kHalfRoot, kHalfRoot};
  expect_near(vertex(bar.b.load(), 5), V3f(-1, 3, 0));
}

TEST(GltfSkin, ThatAreMalformedAreRefusedByTheirElement) {
  Bar far = make_bar();
  far.b.doc["skins"][0]["joints"].erase(1);
  expect_says(error_of(far.b), "mesh 0 primitive 0: vertex 2 names joint 1, but its skin has 1");
  Bar few = make_bar();
  few.b.doc["skins"][0]["joints"] = {1, 2, 1};
  expect_says(error_of(few.b), "skin 0 has 3 joints, but 2 inverseBindMatrices (accessor 4)");
  Bar none = make_bar();
  none.b.doc["skins"][0]["joints"] = json::array();
  expect_says(error_of(none.b), "skin 0 has no joints");
  Bar vectors = make_bar();
  vectors.b.doc["skins"][0]["inverseBindMatrices"] = 0;
  expect_says(error_of(vectors.b), "skin 0 inverseBindMatrices is accessor 0, which is VEC3");
  Bar floats = make_bar();
  floats.b.doc["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 3;
  expect_says(error_of(floats.b), "JOINTS_0 is accessor 3, which is VEC4 of float");
}

}  // namespace
}  // namespace dapple::test
