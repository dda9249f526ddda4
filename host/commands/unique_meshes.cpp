#include "commands/unique_meshes.hpp"

#include <map>
#include <utility>

namespace dapple {
namespace {

/// The nodes of the file that stand for placements, after instances became nodes.
class PlacementNodes {
 public:
  explicit PlacementNodes(gltf::SourceFile& file) : file_(file) {}

  /// Of the next placement of `mesh`, of the scene, by a node of the file.
  std::uint32_t next(std::uint32_t node, std::uint32_t mesh) {
    auto first = first_of_split_.find(node);
    if (first == first_of_split_.end()) {
      if (!file_.has_gpu_instances(node)) return node;
      first = first_of_split_.emplace(node, file_.split_gpu_instances(node)).first;
    }
    return first->second + placements_[{node, mesh}]++;
  }

 private:
  gltf::SourceFile& file_;
  std::map<std::uint32_t, std::uint32_t> first_of_split_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> placements_;
};

}  // namespace

void make_meshes_unique(gltf::SourceFile& file, Scene& scene) {
  std::map<std::uint32_t, std::uint32_t> owner;  // the first node that shows a mesh of the file
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;  // by node and mesh
  std::vector<bool> shown(scene.meshes.size());
  PlacementNodes nodes(file);
  for (Instance& instance : scene.instances) {
    const std::uint32_t mesh = instance.mesh;
    if (scene.meshes[mesh].sources.empty() || instance.node < 0) continue;
    const std::uint32_t in_file = scene.meshes[mesh].sources[0].mesh;
    const std::uint32_t node = nodes.next(static_cast<std::uint32_t>(instance.node), mesh);
    instance.node = static_cast<int>(node);
    const bool is_first = owner.try_emplace(in_file, node).first->second == node;
    if (is_first && !shown[mesh]) {
      shown[mesh] = true;
      continue;
    }
    auto copy = copies.find({node, in_file});
    if (copy == copies.end())
      copy = copies.emplace(std::pair{node, in_file}, file.copy_mesh(node, in_file)).first;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(Mesh(scene.meshes[mesh]));
    for (VertexSource& source : scene.meshes.back().sources) source.mesh = copy->second;
  }
}

}  // namespace dapple
