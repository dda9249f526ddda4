#include "bake/mesh_placements.hpp"

#include <algorithm>

#include "scene/check/invertible.hpp"

namespace dapple {

Placements placed_alone() {
  Placements placements;
  placements.add(M44f());
  return placements;
}

std::vector<Placements> placements_by_mesh(const Scene& scene, BakePlacement kind) {
  if (kind == BakePlacement::alone)
    return std::vector<Placements>(scene.meshes.size(), placed_alone());
  std::vector<Placements> placements(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    if (is_invertible(instance.to_world)) placements[instance.mesh].add(instance.to_world);
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
