// Finds how a node uses its mesh: see mesh_use.hpp.
#include "scene/gltf/pose/mesh_use.hpp"

#include <algorithm>
#include <cmath>

#include "scene/gltf/pose/deformation.hpp"
#include "scene/gltf/topology.hpp"

namespace dapple::gltf {
namespace {

/// Converts a radius from metres to the units of a mesh with this matrix, by its mean scale.
/// Returns `radius` itself when the scale is zero or the result is out of float's range.
float radius_in_mesh(float radius, const Imath::M44d& to_world) {
  const double scale = std::cbrt(std::abs(to_world.determinant()));
  const double in_mesh = scale > 0 ? radius / scale : radius;
  return std::isfinite(static_cast<float>(in_mesh)) && static_cast<float>(in_mesh) > 0
             ? static_cast<float>(in_mesh)
             : radius;
}

bool is_bound_to_joints(const tinygltf::Mesh& mesh) {
  return std::all_of(mesh.primitives.begin(), mesh.primitives.end(), has_joints);
}

/// A node's own weights replace those of its mesh (glTF 2.0, section 3.7.2.2); a pose replaces
/// both. Returns an empty vector when all are 0.
std::vector<double> morph_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh,
                                  const NodePose* moved) {
  std::vector<double> weights = mesh.weights;
  if (!node.weights.empty()) weights = node.weights;
  if (moved != nullptr && moved->weights) weights = *moved->weights;
  const bool none = std::all_of(weights.begin(), weights.end(), [](double w) { return w == 0; });
  return none ? std::vector<double>{} : weights;
}

}  // namespace

MeshUse use_of(const Document& document, const PlacedNode& placed, const Pose& pose,
               const SceneOptions& options) {
  const auto& node = document.model.nodes[static_cast<std::size_t>(placed.node)];
  const auto& mesh = document.model.meshes[static_cast<std::size_t>(node.mesh)];
  const auto found = pose.find(placed.node);
  const NodePose* moved = found == pose.end() ? nullptr : &found->second;
  MeshUse use;
  use.mesh = node.mesh;
  use.colors = options.colors;
  use.weights = morph_weights(node, mesh, moved);
  if (moved != nullptr && moved->weights) use.node = placed.node;
  if (node.skin >= 0 && is_bound_to_joints(mesh)) use.skin = node.skin;
  use.mirrored = use.skin >= 0 && placed.to_world.determinant() < 0;
  if (options.line_radius > 0 && has_lines(mesh)) {
    use.line_radius =
        use.skin >= 0 ? options.line_radius : radius_in_mesh(options.line_radius, placed.to_world);
    if (!pose.empty()) use.node = placed.node;
  }
  return use;
}

}  // namespace dapple::gltf
