#include "rivals/protocols/baked_parts.hpp"

#include <algorithm>
#include <numeric>

#include "bake/two_sided.hpp"
#include "bake/vertex_bake.hpp"

namespace dapple::bench {
namespace {

/// For each vertex group the triangles around it: [first[group], first[group + 1]) of `triangles`.
struct GroupTriangles {
  std::vector<std::uint32_t> first, triangles;

  GroupTriangles(const Mesh& mesh, const VertexGroups& groups)
      : first(groups.count + 1), triangles(mesh.indices.size()) {
    for (const std::uint32_t vertex : mesh.indices) ++first[groups.of_vertex[vertex] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < mesh.indices.size(); ++i)
      triangles[next[groups.of_vertex[mesh.indices[i]]]++] = i / 3;
  }
};

/// The triangles that affect the values of the `chosen` ones: those of the same small part, and
/// those that share a vertex. Sorted.
std::vector<std::uint32_t> with_neighbours(const Mesh& mesh, const VertexGroups& groups,
                                           const std::vector<std::uint32_t>& chosen) {
  const GroupTriangles around(mesh, groups);
  const std::vector<std::uint32_t> part = connected_parts(mesh, groups);
  std::vector<std::uint32_t> part_size(groups.count);
  for (const std::uint32_t p : part) ++part_size[p];
  std::vector<bool> taken(mesh.primitive_count());
  const auto take_around = [&](std::uint32_t group) {
    for (std::uint32_t i = around.first[group]; i < around.first[group + 1]; ++i)
      taken[around.triangles[i]] = true;
  };
  std::vector<bool> part_taken(groups.count);
  for (const std::uint32_t t : chosen) {
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
      take_around(groups.of_vertex[mesh.indices[i]]);
    const std::uint32_t p = part[groups.of_vertex[mesh.indices[3 * t]]];
    part_taken[p] = part_size[p] <= kSmallPart;
  }
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < taken.size(); ++t)
    if (taken[t] || part_taken[part[groups.of_vertex[mesh.indices[3 * t]]]]) triangles.push_back(t);
  return triangles;
}

BakedPart part_of(const Scene& scene, const Mesh& mesh, const std::vector<std::uint32_t>& chosen) {
  const std::vector<bool> two_sided = TwoSided(scene, BakeSides::automatic).triangles(mesh);
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  BakedPart part;
  for (const std::uint32_t t : with_neighbours(mesh, group_vertices(mesh, two_sided), chosen)) {
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i) {
      std::uint32_t& vertex = number[mesh.indices[i]];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(part.mesh.positions.size());
        part.mesh.positions.push_back(mesh.positions[mesh.indices[i]]);
      }
      part.mesh.indices.push_back(vertex);
    }
    part.mesh.materials.push_back(mesh.materials[t]);
    part.two_sided.push_back(two_sided[t]);
  }
  for (const std::uint32_t t : chosen)
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
      part.compared.push_back(number[mesh.indices[i]]);
  std::sort(part.compared.begin(), part.compared.end());
  part.compared.erase(std::unique(part.compared.begin(), part.compared.end()), part.compared.end());
  return part;
}

}  // namespace

std::vector<BakedPart> choose_parts(const Scene& scene, std::size_t triangles) {
  std::size_t all = 0;
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.has_strands()) all += mesh.primitive_count();
  const std::size_t count = std::min(triangles, all);
  std::vector<BakedPart> parts;
  std::size_t before = 0, next = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (mesh.has_strands()) continue;
    std::vector<std::uint32_t> chosen;
    for (; next < count && next * all / count < before + mesh.primitive_count(); ++next)
      chosen.push_back(static_cast<std::uint32_t>(next * all / count - before));
    before += mesh.primitive_count();
    BakedPart part;
    if (!chosen.empty()) part = part_of(scene, mesh, chosen);
    for (const Instance& instance : scene.instances)
      if (instance.mesh == m) part.placements.add(instance.to_world);
    if (!chosen.empty() && !part.placements.to_world.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace dapple::bench
