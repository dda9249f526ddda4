// Groups the vertices of a mesh that are one point of its surface: at the same position, with
// similar normals. Exporters split vertices at seams of textures; baked values must not differ
// there.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

struct VertexGroups {
  std::vector<std::uint32_t> of_vertex;  ///< group of each vertex
  std::vector<bool> turned;              ///< by vertex: its front is the back of its group
  std::size_t count = 0;
};

/// Groups by the mean normals of the triangles around each vertex: within 45 degrees of the group's
/// first vertex, whose front is that of the group. Groups are numbered by their first vertex.
/// Vertices whose triangles are all two-sided (`two_sided`, by triangle; empty: none) may have
/// opposite normals. Linear in the vertices but for a sort.
VertexGroups group_vertices(const Mesh& mesh, const std::vector<bool>& two_sided = {});

/// For each vertex the first one at the same position.
std::vector<std::uint32_t> places_of_vertices(const Mesh& mesh);

/// All vertices as one group.
VertexGroups one_group(std::size_t vertices);

/// Sheets of at most so many vertices, such as leaves, have one better side.
inline constexpr std::size_t kSmallPart = 64;

/// For each group the connected part of the mesh that it belongs to: groups joined by triangles.
/// Parts are numbered by their first group.
std::vector<std::uint32_t> connected_parts(const Mesh& mesh, const VertexGroups& groups);

/// Cross product of two edges of a triangle: along the front side's normal, twice the area long.
V3f area_vector(const Mesh& mesh, std::size_t triangle);

}  // namespace dapple
