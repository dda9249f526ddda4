// Animations, skins and morph targets with wrong elements, and small files whose skins or targets
// would need too much work. All are refused even at rest.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

void add(MalformedCases& cases, const std::string& name, const GltfBuilder& builder,
         const std::string& says) {
  cases.push_back({"motion_" + name, as_glb(builder), says});
}

/// A triangle whose node moves by two keyframes. Accessor 1 has the times, accessor 2 the
/// translations.
GltfBuilder moved() {
  GltfBuilder b = one_triangle();
  b.add_movement(0, {0, 1}, {0, 0, 0, 1, 1, 1});
  return b;
}

void add_animations(MalformedCases& cases) {
  const auto edited = [&](const std::string& name, const std::string& says,
                          const std::function<void(json&)>& edit) {
    GltfBuilder b = moved();
    edit(b.doc);
    add(cases, name, b, says);
  };
  edited("of_unknown_times", "animation 0 sampler 0 names accessor 9",
         [](json& d) { d["animations"][0]["samplers"][0]["input"] = 9; });
  edited("of_an_unknown_node", "animation 0 channel 0 names node 9",
         [](json& d) { d["animations"][0]["channels"][0]["target"]["node"] = 9; });
  edited("of_times_in_three_dimensions", "channel 0 input is accessor 2, which is VEC3",
         [](json& d) { d["animations"][0]["samplers"][0]["input"] = 2; });
  edited("of_rotations_in_three_dimensions", "channel 0 output is accessor 2, which is VEC3",
         [](json& d) { d["animations"][0]["channels"][0]["target"]["path"] = "rotation"; });
  edited("of_places_in_one_dimension", "channel 0 output is accessor 1, which is SCALAR",
         [](json& d) { d["animations"][0]["samplers"][0]["output"] = 1; });
  edited("of_too_few_values", "has 2 keyframes of 3 values, but 2 values",
         [](json& d) { d["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; });
  edited("of_too_many_values", "has 1 keyframes of 1 values, but 2 values",
         [](json& d) { d["accessors"][1]["count"] = 1; });
  edited("of_a_node_with_a_matrix", "moves node 0, which has a matrix", [](json& d) {
    d["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  });
  edited("of_an_unknown_interpolation", "interpolation is \"SMOOTH\"",
         [](json& d) { d["animations"][0]["samplers"][0]["interpolation"] = "SMOOTH"; });
}

/// A triangle whose vertices follow one joint. Accessor 1 has the joints, accessor 2 the weights.
GltfBuilder skinned(std::uint8_t joint = 0) {
  GltfBuilder b = one_triangle();
  const int joints = b.add_accessor(std::vector<std::uint8_t>(12, joint), kUint8, "VEC4");
  const int weights = b.add_accessor(std::vector<float>(12, 0.25f), kFloat, "VEC4");
  json& attributes = b.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = joints;
  attributes["WEIGHTS_0"] = weights;
  b.add("nodes", json::object());
  b.add("skins", {{"joints", {1}}});
  b.doc["nodes"][0]["skin"] = 0;
  return b;
}

void add_skins(MalformedCases& cases) {
  add(cases, "of_a_joint_that_the_skin_lacks", skinned(1),
      "mesh 0 primitive 0: vertex 0 names joint 1, but its skin has 1");
  GltfBuilder joints = skinned();
  joints.doc["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 2;
  add(cases, "of_joints_that_are_floats", joints, "JOINTS_0 is accessor 2, which is VEC4 of float");
  GltfBuilder weights = skinned();
  weights.doc["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = 0;
  add(cases, "of_weights_in_three_dimensions", weights, "WEIGHTS_0 is accessor 0, which is VEC3");
  GltfBuilder matrices = skinned();
  matrices.doc["skins"][0]["inverseBindMatrices"] = 2;
  add(cases, "of_inverse_vectors", matrices, "skin 0 inverseBindMatrices is accessor 2");
  GltfBuilder none = skinned();
  none.doc["skins"][0]["joints"] = json::array();
  add(cases, "of_no_joints", none, "skin 0 has no joints");
}

/// Many vertices, which need no bytes, with 70 sets of joints and weights each.
void add_bombs_of_joints(MalformedCases& cases) {
  GltfBuilder b;
  constexpr int kVertices = 3999999;
  const auto zeros = [&](int component, const char* type) {
    return b.add("accessors", {{"componentType", component}, {"count", kVertices}, {"type", type}});
  };
  json attributes = {{"POSITION", zeros(kFloat, "VEC3")}};
  const int joints = zeros(kUint8, "VEC4"), weights = zeros(kFloat, "VEC4");
  for (int set = 0; set < 70; ++set) {
    attributes["JOINTS_" + std::to_string(set)] = joints;
    attributes["WEIGHTS_" + std::to_string(set)] = weights;
  }
  b.add_mesh({{"attributes", attributes}});
  b.add("nodes", json::object());
  b.add("skins", {{"joints", {1}}});
  b.doc["nodes"][0]["skin"] = 0;
  add(cases, "of_many_joints_a_vertex", b, "brings the numbers that deform vertices to");
}

void add_bombs_of_targets(MalformedCases& cases) {
  GltfBuilder b;
  const int zeros =
      b.add("accessors", {{"componentType", kFloat}, {"count", 3999999}, {"type", "VEC3"}});
  json targets = json::array(), weights = json::array();
  for (int target = 0; target < 280; ++target) {
    targets.push_back({{"POSITION", zeros}});
    weights.push_back(1);
  }
  b.add_mesh({{"attributes", {{"POSITION", zeros}}}, {"targets", targets}});
  b.doc["meshes"][0]["weights"] = weights;
  add(cases, "of_many_targets", b, "brings the numbers that deform vertices to");
}

}  // namespace

void add_wrong_motion(MalformedCases& cases) {
  add_animations(cases);
  add_skins(cases);
  add_bombs_of_joints(cases);
  add_bombs_of_targets(cases);
}

}  // namespace dapple::test
