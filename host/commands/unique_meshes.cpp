#include "commands/unique_meshes.hpp"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "dapple/error.hpp"

namespace dapple {

void make_meshes_unique(gltf::SourceFile& file, Scene& scene) {
  std::map<std::uint32_t, int> owner;  // the first node that shows a mesh of the file
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> copies;  // by node and mesh of the file
  std::vector<bool> shown(scene.meshes.size());
  for (Instance& instance : scene.instances) {
    const std::uint32_t mesh = instance.mesh;
    if (scene.meshes[mesh].sources.empty() || instance.node < 0) continue;
    const std::uint32_t in_file = scene.meshes[mesh].sources[0].mesh;
    const auto node = static_cast<std::uint32_t>(instance.node);
    const bool is_first = owner.try_emplace(in_file, instance.node).first->second == instance.node;
    if (file.has_gpu_instances(node))
      throw Error(ErrorKind::usage,
                  fmt::format("--instances is unique, but node {} has instances by "
                              "EXT_mesh_gpu_instancing, which share one mesh; --to instance gives "
                              "each a value",
                              node));
    if (is_first && !shown[mesh]) {
      shown[mesh] = true;
      continue;
    }
    auto copy = copies.find({instance.node, in_file});
    if (copy == copies.end())
      copy = copies.emplace(std::pair{instance.node, in_file}, file.copy_mesh(node, in_file)).first;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(Mesh(scene.meshes[mesh]));
    for (VertexSource& source : scene.meshes.back().sources) source.mesh = copy->second;
  }
}

}  // namespace dapple
