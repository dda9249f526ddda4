#include "bake/mesh_placements.hpp"

#include <algorithm>

#include "scene/check/invertible.hpp"

namespace dapple {

Placements placements_of(const Scene& scene, std::uint32_t mesh, BakePlacement kind) {
  Placements placements;
  if (kind == BakePlacement::alone) {
    placements.add(M44f());
    return placements;
  }
  for (const Instance& instance : scene.instances)
    if (instance.mesh == mesh && is_invertible(instance.to_world))
      placements.add(instance.to_world);
  return placements;
}

std::vector<std::size_t> placement_counts(const Scene& scene, BakePlacement kind) {
  const bool alone = kind == BakePlacement::alone;
  std::vector<std::size_t> counts(scene.meshes.size(), alone ? 1 : 0);
  for (const Instance& instance : scene.instances)
    if (!alone && is_invertible(instance.to_world)) ++counts[instance.mesh];
  return counts;
}

std::size_t count_vanished_meshes(const Scene& scene) {
  const std::vector<std::size_t> counts = placement_counts(scene, BakePlacement::together);
  std::vector<bool> vanished(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    vanished[instance.mesh] =
        counts[instance.mesh] == 0 && !scene.meshes[instance.mesh].has_strands();
  return static_cast<std::size_t>(std::count(vanished.begin(), vanished.end(), true));
}

}  // namespace dapple
