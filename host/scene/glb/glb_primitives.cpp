#include "scene/glb/glb_primitives.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace dapple {
namespace {

bool has_normals(const Mesh& mesh, const std::uint32_t* corners) {
  return !mesh.normals.empty() && std::all_of(corners, corners + 3, [&](std::uint32_t v) {
    return mesh.normals[v].length2() > 0;
  });
}

/// Keeps only the vertices that the primitive uses, in the order in which its triangles do.
void keep_used_vertices(GlbPrimitive& primitive, std::size_t vertex_count) {
  constexpr auto kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> numbers(vertex_count, kUnused);
  for (std::uint32_t& index : primitive.indices) {
    std::uint32_t& number = numbers[index];
    if (number == kUnused) {
      number = static_cast<std::uint32_t>(primitive.vertices.size());
      primitive.vertices.push_back(index);
    }
    index = number;
  }
}

}  // namespace

std::vector<GlbPrimitive> split_into_primitives(const Mesh& mesh, std::size_t material_count) {
  std::vector<GlbPrimitive> all(2 * material_count);
  for (std::size_t triangle = 0; triangle < mesh.primitive_count(); ++triangle) {
    const std::uint32_t* const corners = &mesh.indices[3 * triangle];
    auto& indices = all[2 * mesh.materials[triangle] + has_normals(mesh, corners)].indices;
    indices.insert(indices.end(), corners, corners + 3);
  }
  std::vector<GlbPrimitive> primitives;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].indices.empty()) continue;
    all[i].material = i / 2;
    if (i % 2 == 1) keep_used_vertices(all[i], mesh.positions.size());
    primitives.push_back(std::move(all[i]));
  }
  return primitives;
}

}  // namespace dapple
