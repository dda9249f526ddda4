// Makes instances and mesh lights: see instance.hpp.
#include "scene/gltf/instance.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/extension_names.hpp"
#include "scene/gltf/mesh.hpp"
#include "scene/gltf/pose/deformation.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Imath::M44d;
using Imath::V3d;
using Imath::V4d;

/// The limit of instances. Nodes may share accessors of instances, so a small file could otherwise
/// make any number; above 2^22 instances the limit grows with the file's size.
std::uint64_t max_instances(const Document& document) {
  constexpr std::uint64_t kMax = std::uint64_t{1} << 25;
  return std::min(kMax, (std::uint64_t{1} << 22) + document.bytes);
}

/// The accessors of EXT_mesh_gpu_instancing; each of them may be absent.
struct InstanceAttributes {
  std::optional<AccessorReader> translation;
  std::optional<AccessorReader> rotation;
  std::optional<AccessorReader> scale;
  std::uint64_t count = 0;
};

std::optional<AccessorReader> instance_attribute(const Document& document,
                                                 const tinygltf::Value& attributes,
                                                 const char* name, const std::string& who, int type,
                                                 std::initializer_list<Component> components) {
  if (!attributes.Has(name)) return {};
  const int accessor = attributes.Get(name).GetNumberAsInt();
  require_type(document, accessor, fmt::format("{} instance {}", who, name), {type}, components);
  return AccessorReader(document, accessor);
}

InstanceAttributes read_instance_attributes(const Document& document,
                                            const tinygltf::Value& attributes,
                                            const std::string& who) {
  InstanceAttributes result;
  result.translation = instance_attribute(document, attributes, "TRANSLATION", who,
                                          TINYGLTF_TYPE_VEC3, {Component::float32});
  result.rotation = instance_attribute(document, attributes, "ROTATION", who, TINYGLTF_TYPE_VEC4,
                                       {Component::float32, Component::int8, Component::int16});
  result.scale = instance_attribute(document, attributes, "SCALE", who, TINYGLTF_TYPE_VEC3,
                                    {Component::float32});
  bool first = true;
  for (const std::string& name : attributes.Keys()) {
    const int accessor = attributes.Get(name).GetNumberAsInt();
    const std::uint64_t count = document.model.accessors[static_cast<std::size_t>(accessor)].count;
    if (!first && count != result.count) {
      fail(document.file, "{}: instance attributes differ in length ({} and {} of {})", who,
           grouped(result.count), grouped(count), name);
    }
    result.count = count;
    first = false;
  }
  return result;
}

M44d instance_matrix(const InstanceAttributes& instances, std::uint64_t i) {
  const V3d translation = instances.translation ? V3d(instances.translation->vec3(i)) : V3d(0.0);
  const V4d rotation = instances.rotation ? unit_rotation(*instances.rotation, i) : V4d(0, 0, 0, 1);
  const V3d scale = instances.scale ? V3d(instances.scale->vec3(i)) : V3d(1.0);
  return compose(translation, rotation, scale);
}

/// Returns the world matrices of all instances that one node makes of its mesh. `so_far` is the
/// number of instances before them.
std::vector<M44d> node_matrices(const Document& document, const PlacedNode& placed, bool is_skinned,
                                std::uint64_t so_far) {
  const auto& node = document.model.nodes[static_cast<std::size_t>(placed.node)];
  const auto instancing = node.extensions.find(extension::kInstancing);
  if (instancing == node.extensions.end() || !instancing->second.Has("attributes")) {
    return {placed.to_world};
  }
  const std::string who = element("node", static_cast<std::size_t>(placed.node), node.name);
  const InstanceAttributes instances =
      read_instance_attributes(document, instancing->second.Get("attributes"), who);
  if (so_far + instances.count > max_instances(document)) {
    fail(document.file, "{} brings the instances to {} (at most {} in a scene of {} bytes)", who,
         grouped(so_far + instances.count), grouped(max_instances(document)),
         grouped(document.bytes));
  }
  std::vector<M44d> matrices;
  matrices.reserve(instances.count);
  for (std::uint64_t i = 0; i < instances.count; ++i) {
    const M44d of_instance = instance_matrix(instances, i);
    // Joints have placed a skinned mesh already, but for its mirror image.
    matrices.push_back(is_skinned ? placed.to_world * of_instance : of_instance * placed.to_world);
  }
  return matrices;
}

int add_mesh_light(const Material& material, const std::string& node_name, Scene& scene) {
  Light light;
  light.name = node_name.empty() ? material.name : one_line(node_name);
  light.kind = LightKind::mesh;
  light.radiance = material.emission;
  light.double_sided = material.double_sided;
  scene.lights.push_back(std::move(light));
  return static_cast<int>(scene.lights.size()) - 1;
}

void add_placement(const std::vector<MeshPart>& parts, const M44d& to_world, int node,
                   const std::string& node_name, Scene& scene) {
  for (const MeshPart& part : parts) {
    Instance instance;
    instance.node = node;
    instance.mesh = part.mesh;
    instance.to_world = M44f(to_world);
    if (part.emitter >= 0) {
      instance.light =
          add_mesh_light(scene.materials[static_cast<std::size_t>(part.emitter)], node_name, scene);
    }
    scene.instances.push_back(instance);
  }
}

/// Adds one warning for a feature, with the number of its occurrences.
void warn(const std::string& file, std::uint64_t count, const char* what, Scene& scene) {
  if (count == 0) return;
  scene.warnings.push_back(
      one_line(fmt::format("{}: {} ({} of them)", file, what, grouped(count))));
}

/// The same with the first element that has it.
void warn(const std::string& file, const Found& found, const char* what, Scene& scene) {
  if (found.count == 0) return;
  scene.warnings.push_back(one_line(fmt::format("{}: {}", file, found.note(what))));
}

void warn_of_totals(const std::string& file, const MeshTotals& totals, std::uint64_t unbound,
                    Scene& scene) {
  warn(
      file, totals.thin_lines,
      "line primitives are ignored: --line-radius R makes strands of them (dapple render and info)",
      scene);
  warn(file, totals.points, "point primitives are ignored", scene);
  warn(file, totals.textured_lines,
       "line primitives have a texture, which is ignored: their factor alone is their opacity",
       scene);
  warn(file, totals.shining_lines, "line primitives emit, which is ignored", scene);
  warn(file, totals.without_position, "primitives without POSITION are ignored", scene);
  warn(file, totals.without_texcoord,
       "lacks the TEXCOORD of its base colour texture and uses the texel at 0,0", scene);
  warn(file, totals.without_primitives, "has no primitives, which glTF demands", scene);
  warn(file, totals.without_elements, "has too few vertices for a triangle or segment", scene);
  warn(file, totals.without_view, "has a POSITION without a bufferView: all vertices are at 0,0,0",
       scene);
  warn(file, totals.odd_texcoords, "has texture coordinates that are not finite: they count as 0,0",
       scene);
  warn(file, totals.odd_alphas, "has vertex alphas that are NaN: they count as 0", scene);
  warn(file, totals.fixed_attributes,
       "has morph targets of colours or texture coordinates, which are ignored", scene);
  warn(file, unbound, "skinned nodes have meshes without JOINTS_0 and WEIGHTS_0, which stay rigid",
       scene);
}

/// The joint matrices of skins at a pose, computed at their first use.
class Skeletons {
 public:
  Skeletons(const Document& document, const Pose& pose) : document_(document), pose_(pose) {}

  /// From the mesh in its bind pose to the space that placement() places. Returns null for a use
  /// without a skin.
  const std::vector<M44d>* joints(const MeshUse& use) {
    if (use.skin < 0) return nullptr;
    const auto [known, is_new] = joints_.try_emplace({use.skin, use.mirrored});
    if (!is_new) return &known->second;
    if (world_.empty()) world_ = world_matrices(document_, pose_);
    known->second = joint_matrices(document_, use.skin, world_);
    if (use.mirrored)
      for (M44d& joint : known->second) joint *= mirror();
    return &known->second;
  }

  /// Joints place a skinned mesh; glTF says that its node's own matrix is ignored, but for the
  /// winding of its triangles, which the sign of its determinant tells (section 3.7.4).
  static PlacedNode placement(const MeshUse& use, const PlacedNode& at) {
    if (use.skin < 0) return at;
    return {at.node, use.mirrored ? mirror() : M44d()};
  }

 private:
  static M44d mirror() { return M44d().scale(V3d(-1, 1, 1)); }

  const Document& document_;
  const Pose& pose_;
  std::vector<M44d> world_;
  std::map<std::pair<int, bool>, std::vector<M44d>> joints_;  // by skin and MeshUse::mirrored
};

/// Returns the accessor of a skin's inverse bind matrices, -1 for none.
int inverse_of(const Document& document, const MeshUse& use) {
  return document.motion.skins[static_cast<std::size_t>(use.skin)].inverse_matrices;
}

}  // namespace

V4d unit_rotation(const AccessorReader& rotations, std::uint64_t i) {
  V4d rotation;
  for (int c = 0; c < 4; ++c) {
    rotation[c] = double{rotations.normalized(i, static_cast<std::uint64_t>(c))};
  }
  const double length = rotation.length();
  return length > 0 ? rotation / length : V4d(0, 0, 0, 1);
}

void add_instances(const Document& document, const std::vector<PlacedNode>& placed,
                   const MaterialSet& materials, const Pose& pose, const SceneOptions& options,
                   Scene& scene) {
  std::map<MeshUse, std::vector<MeshPart>> parts_of_use;
  Skeletons skeletons(document, pose);
  MeshTotals totals;
  std::uint64_t unbound = 0;
  for (const PlacedNode& at : placed) {
    const auto& node = document.model.nodes[static_cast<std::size_t>(at.node)];
    if (node.mesh < 0) continue;
    const MeshUse use = use_of(document, at, pose, options);
    if (node.skin >= 0 && use.skin < 0) ++unbound;
    auto known = parts_of_use.find(use);
    if (known == parts_of_use.end()) {
      if (use.skin >= 0) totals.sparse_values += sparse_count(document, inverse_of(document, use));
      auto parts = read_mesh(document, use, skeletons.joints(use), materials, scene, totals);
      known = parts_of_use.emplace(use, std::move(parts)).first;
    }
    if (known->second.empty()) continue;
    const PlacedNode placed_at = Skeletons::placement(use, at);
    for (const M44d& to_world :
         node_matrices(document, placed_at, use.skin >= 0, scene.instances.size())) {
      add_placement(known->second, to_world, at.node, node.name, scene);
    }
  }
  warn_of_totals(document.file, totals, unbound, scene);
  if (!scene.instances.empty()) return;
  fail(document.file, "has no triangles{}",
       totals.thin_lines > 0
           ? "; --line-radius R makes strands of its lines (dapple render and info)"
           : "");
}

}  // namespace dapple::gltf
