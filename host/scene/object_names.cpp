// name_objects(): which instances are one object to those who select objects by name. In: nodes and
// meshes with names. Out: numbers of names.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "dapple/scene.hpp"

namespace dapple {
namespace {

std::string object_name(const Scene& scene, const Instance& instance) {
  if (instance.node < 0) {
    const std::string& mesh = scene.meshes[instance.mesh].name;
    return mesh.empty() ? fmt::format("mesh_{}", instance.mesh) : mesh;
  }
  const auto node = static_cast<std::size_t>(instance.node);
  const bool named = node < scene.node_names.size() && !scene.node_names[node].empty();
  return named ? scene.node_names[node] : fmt::format("node_{}", node);
}

}  // namespace

void name_objects(Scene& scene) {
  const bool is_merged = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                     [](const Mesh& mesh) { return !mesh.objects.empty(); });
  if (is_merged) return;  // by merge_single_instances(), after they had names
  scene.objects.clear();
  std::map<std::string, int> numbers;
  for (Instance& instance : scene.instances) {
    std::string name = object_name(scene, instance);
    const auto [found, is_new] = numbers.try_emplace(name, static_cast<int>(numbers.size()));
    if (is_new) scene.objects.push_back(std::move(name));
    instance.object = found->second;
  }
}

}  // namespace dapple
