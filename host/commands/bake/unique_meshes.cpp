#include "commands/bake/unique_meshes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace dapple {
namespace {

/// The nodes of the file that stand for placements, after instances became nodes.
class PlacementNodes {
 public:
  explicit PlacementNodes(gltf::SourceFile& file) : file_(file) {}

  /// Whether the instances of a node stay together: nodes of a skin have no places of their own.
  /// A mesh without joints is not skinned.
  [[nodiscard]] bool keeps_instances(int node, const VertexSource& source) const {
    const auto in_file = static_cast<std::uint32_t>(node);
    const std::vector<std::string> names = file_.attributes(source.mesh, source.primitive);
    return file_.has_gpu_instances(in_file) && file_.has_skin(in_file) &&
           std::find(names.begin(), names.end(), "JOINTS_0") != names.end();
  }

  /// Of the next placement of `mesh`, of the scene, by a node of the file; -1 if it has none.
  int next(int node, std::uint32_t mesh, bool stays) {
    auto split = split_.find(node);
    if (split == split_.end()) {
      const auto in_file = static_cast<std::uint32_t>(node);
      if (!file_.has_gpu_instances(in_file) || stays) return node;
      if (file_.has_instance_features(in_file)) ++without_features_;
      split = split_.emplace(node, file_.split_gpu_instances(in_file)).first;
    }
    return split->second.at(placements_[{node, mesh}]++);
  }

  /// After the last placement.
  void finish() { file_.finish_splits(split_); }

  /// Nodes whose instances lost the numbers of their features.
  [[nodiscard]] int without_features() const { return without_features_; }

 private:
  gltf::SourceFile& file_;
  int without_features_ = 0;
  std::map<int, std::vector<int>> split_;
  std::map<std::pair<int, std::uint32_t>, std::size_t> placements_;
};

/// Instances whose node is kLeftOut are in the scene, not in the file.
constexpr int kLeftOut = -2;

void remove_left_out(Scene& scene) {
  const auto count = std::erase_if(
      scene.instances, [](const Instance& instance) { return instance.node == kLeftOut; });
  if (count > 0)
    scene.warnings.push_back(
        fmt::format("{}: instances whose places are not finite are left out ({} of them)",
                    scene.source, count));
}

}  // namespace

void make_meshes_unique(gltf::SourceFile& file, Scene& scene) {
  std::map<std::uint32_t, std::uint32_t> owner;  // the first node that shows a mesh of the file
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;  // by node and mesh
  std::vector<bool> shown(scene.meshes.size());
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> kept;  // meshes of instances that stay
  std::set<int> nodes_with_instances;
  PlacementNodes nodes(file);
  for (Instance& instance : scene.instances) {
    const std::uint32_t mesh = instance.mesh;
    if (scene.meshes[mesh].sources.empty() || instance.node < 0) continue;
    const auto together = kept.find({instance.node, mesh});
    if (together != kept.end()) {
      instance.mesh = together->second;
      continue;
    }
    const std::uint32_t in_file = scene.meshes[mesh].sources[0].mesh;
    const bool stays = nodes.keeps_instances(instance.node, scene.meshes[mesh].sources[0]);
    const int placed = nodes.next(instance.node, mesh, stays);
    instance.node = placed < 0 ? kLeftOut : placed;
    if (placed < 0) continue;
    const auto node = static_cast<std::uint32_t>(placed);
    const bool is_first = owner.try_emplace(in_file, node).first->second == node;
    if (is_first && !shown[mesh]) {
      shown[mesh] = true;
    } else {
      auto copy = copies.find({node, in_file});
      if (copy == copies.end())
        copy = copies.emplace(std::pair{node, in_file}, file.copy_mesh(node, in_file)).first;
      instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
      scene.meshes.push_back(Mesh(scene.meshes[mesh]));
      for (VertexSource& source : scene.meshes.back().sources) source.mesh = copy->second;
    }
    if (!stays) continue;
    kept[{placed, mesh}] = instance.mesh;
    nodes_with_instances.insert(placed);
  }
  nodes.finish();
  remove_left_out(scene);
  if (!kept.empty())
    scene.warnings.push_back(fmt::format(
        "{}: skinned meshes with EXT_mesh_gpu_instancing keep it: a skin's nodes have no places, "
        "so the instances of each share their values ({} of them)",
        scene.source, nodes_with_instances.size()));
  if (nodes.without_features() > 0)
    scene.warnings.push_back(fmt::format(
        "{}: EXT_instance_features of instances that became nodes is left out ({} of them)",
        scene.source, nodes.without_features()));
}

}  // namespace dapple
