// Morphing and skinning of vertices: see deformation.hpp.
#include "scene/gltf/pose/deformation.hpp"

#include <algorithm>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::M44d;
using Imath::V3d;
using Imath::V3f;

int find(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

/// Returns how many sets of four joints a vertex has: JOINTS_0 and WEIGHTS_0, JOINTS_1 and
/// WEIGHTS_1, and so on.
int influence_sets(const tinygltf::Primitive& primitive) {
  const auto& attributes = primitive.attributes;
  int sets = 0;
  while (find(attributes, fmt::format("JOINTS_{}", sets)) >= 0 &&
         find(attributes, fmt::format("WEIGHTS_{}", sets)) >= 0)
    ++sets;
  return sets;
}

/// Returns the targets that change an attribute of a primitive: their weight and the accessor of
/// its differences.
std::vector<std::pair<double, int>> active_targets(const tinygltf::Primitive& primitive,
                                                   const std::vector<double>& weights,
                                                   const char* attribute) {
  std::vector<std::pair<double, int>> active;
  for (std::size_t t = 0; t < std::min(primitive.targets.size(), weights.size()); ++t) {
    const int differences = find(primitive.targets[t], attribute);
    if (weights[t] != 0 && differences >= 0) active.emplace_back(weights[t], differences);
  }
  return active;
}

/// Returns p M for an affine matrix.
V3d moved(const V3d& p, const M44d& m) {
  V3d result;
  for (int k = 0; k < 3; ++k) result[k] = p.x * m[0][k] + p.y * m[1][k] + p.z * m[2][k] + m[3][k];
  return result;
}

}  // namespace

bool has_joints(const tinygltf::Primitive& primitive) { return influence_sets(primitive) > 0; }

std::uint64_t deformation_cost(const Document& document, const tinygltf::Primitive& primitive,
                               const Deformation& deformation, std::uint64_t vertices) {
  std::uint64_t cost = 0;
  for (const char* attribute : {"POSITION", "NORMAL"}) {
    for (const auto& [weight, accessor] : active_targets(primitive, deformation.weights, attribute))
      cost += vertices + sparse_count(document, accessor);
  }
  if (deformation.joints != nullptr)
    cost += vertices * 4 * static_cast<std::uint64_t>(influence_sets(primitive));
  return cost;
}

VertexDeformer::VertexDeformer(const Document& document, const tinygltf::Primitive& primitive,
                               const Deformation& deformation, const std::string& who)
    : deformation_(deformation), file_(document.file), who_(who) {
  read_targets(document, primitive);
  if (deformation.joints != nullptr) read_influences(document, primitive);
}

void VertexDeformer::read_targets(const Document& document, const tinygltf::Primitive& primitive) {
  const auto read = [&](const std::string& attribute, auto& targets) {
    for (const auto& [weight, accessor] :
         active_targets(primitive, deformation_.weights, attribute.c_str())) {
      require_type(document, accessor, who_ + " target " + attribute, {TINYGLTF_TYPE_VEC3},
                   {Component::float32, Component::int8, Component::uint8, Component::int16,
                    Component::uint16});
      targets.emplace_back(weight, AccessorReader(document, accessor));
    }
  };
  read("POSITION", targets_);
  read("NORMAL", normal_targets_);
}

void VertexDeformer::read_influences(const Document& document,
                                     const tinygltf::Primitive& primitive) {
  for (int set = 0; set < influence_sets(primitive); ++set) {
    const std::string joints = fmt::format("JOINTS_{}", set);
    const std::string weights = fmt::format("WEIGHTS_{}", set);
    const int joint_accessor = find(primitive.attributes, joints);
    const int weight_accessor = find(primitive.attributes, weights);
    require_type(document, joint_accessor, who_ + " " + joints, {TINYGLTF_TYPE_VEC4},
                 {Component::uint8, Component::uint16});
    require_type(document, weight_accessor, who_ + " " + weights, {TINYGLTF_TYPE_VEC4},
                 {Component::float32, Component::uint8, Component::uint16});
    influences_.push_back(
        {AccessorReader(document, joint_accessor), AccessorReader(document, weight_accessor)});
  }
}

V3f VertexDeformer::position(V3f base, std::uint64_t i) const {
  if (targets_.empty() && influences_.empty()) return base;
  V3d position(base);
  for (const auto& [weight, target] : targets_) position += V3d(target.vec3(i)) * weight;
  return V3f(influences_.empty() ? position : carried(position, i));
}

/// Planes turn by the cofactors of the matrix that moves the vertices. A mirroring joint turns the
/// sign of its normals, which does not matter: a triangle's normals are kept on the side of its
/// face's (pack_normals()).
V3d VertexDeformer::normal(V3f base, std::uint64_t i) const {
  V3d normal(base);
  for (const auto& [weight, target] : normal_targets_) normal += V3d(target.vec3(i)) * weight;
  if (influences_.empty()) return normal;
  const M44d m = blended(i);
  const V3d rows[3] = {
      {m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  return rows[1].cross(rows[2]) * normal.x + rows[2].cross(rows[0]) * normal.y +
         rows[0].cross(rows[1]) * normal.z;
}

/// The matrix of carried(), times the sum of the weights.
M44d VertexDeformer::blended(std::uint64_t i) const {
  M44d sum(0.0);
  bool any = false;
  for (const Influences& set : influences_) {
    for (std::uint64_t k = 0; k < 4; ++k) {
      const double weight = double{set.weights.normalized(i, k)};
      if (weight == 0) continue;
      sum += joint(set, i, k) * weight;
      any = true;
    }
  }
  return any ? sum : joint(influences_.front(), i, 0);
}

/// Divides by the sum of the weights, because exporters round them. A vertex without weights moves
/// with its first joint.
V3d VertexDeformer::carried(const V3d& position, std::uint64_t i) const {
  V3d sum(0.0);
  double total = 0;
  for (const Influences& set : influences_) {
    for (std::uint64_t k = 0; k < 4; ++k) {
      const double weight = double{set.weights.normalized(i, k)};
      if (weight == 0) continue;  // the joint of an unused weight may be any number
      sum += moved(position, joint(set, i, k)) * weight;
      total += weight;
    }
  }
  return total != 0 ? sum / total : moved(position, joint(influences_.front(), i, 0));
}

const M44d& VertexDeformer::joint(const Influences& set, std::uint64_t i, std::uint64_t k) const {
  const auto number = static_cast<std::size_t>(set.joints.number(i, k));
  if (number < deformation_.joints->size()) return (*deformation_.joints)[number];
  fail(file_, "{}: vertex {} names joint {}, but its skin has {}", who_, grouped(i), number,
       grouped(deformation_.joints->size()));
}

std::vector<M44d> joint_matrices(const Document& document, int skin,
                                 const std::vector<M44d>& world) {
  const Skin& given = document.motion.skins[static_cast<std::size_t>(skin)];
  std::vector<M44d> matrices;
  matrices.reserve(given.joints.size());
  for (const int joint : given.joints) matrices.push_back(world[static_cast<std::size_t>(joint)]);
  if (given.inverse_matrices < 0) return matrices;
  const AccessorReader inverse(document, given.inverse_matrices);
  for (std::size_t j = 0; j < matrices.size(); ++j) {
    M44d bind = inverse.matrix(j);
    // Sets the last column to exactly 0, 0, 0, 1: exporters round it.
    for (int row = 0; row < 4; ++row) bind[row][3] = row == 3 ? 1 : 0;
    matrices[j] = bind * matrices[j];
  }
  return matrices;
}

}  // namespace dapple::gltf
