#include "scene/gltf/line_joints.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace dapple::gltf {
namespace {

auto place(const Mesh& mesh, std::uint32_t vertex) {
  const V3f& at = mesh.positions[vertex];
  return std::tuple(at.x, at.y, at.z);
}

bool look_alike(const Mesh& mesh, std::uint32_t a, std::uint32_t b) {
  return (mesh.vertex_alpha.empty() || mesh.vertex_alpha[a] == mesh.vertex_alpha[b]) &&
         (mesh.colors.empty() || mesh.colors[a] == mesh.colors[b]);
}

}  // namespace

void join_lines(Mesh& mesh, std::size_t first_vertex, std::size_t first_index) {
  // Of each end of a segment its vertex, ordered by places: ends that meet follow each other.
  std::vector<std::uint32_t> ends(mesh.indices.begin() + static_cast<std::ptrdiff_t>(first_index),
                                  mesh.indices.end());
  const auto finite = [&](std::uint32_t v) {
    const V3f& at = mesh.positions[v];
    return std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z);
  };
  std::erase_if(ends, [&](std::uint32_t v) { return !finite(v); });
  std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(place(mesh, a), a) < std::tuple(place(mesh, b), b);
  });
  std::vector<std::uint32_t> joined(mesh.positions.size() - first_vertex);
  std::iota(joined.begin(), joined.end(), static_cast<std::uint32_t>(first_vertex));
  for (std::size_t first = 0, end = 0; first < ends.size(); first = end) {
    while (end < ends.size() && place(mesh, ends[end]) == place(mesh, ends[first])) ++end;
    if (end - first == 2 && look_alike(mesh, ends[first], ends[first + 1]))
      joined[ends[first + 1] - first_vertex] = ends[first];
  }
  for (std::size_t i = first_index; i < mesh.indices.size(); ++i)
    mesh.indices[i] = joined[mesh.indices[i] - first_vertex];
}

}  // namespace dapple::gltf
