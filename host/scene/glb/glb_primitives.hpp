// Splits a mesh into the primitives of a glTF file. In: a mesh. Out: the triangles of each
// material, those with normals apart, since a primitive of glTF has a normal at every vertex or at
// none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

struct GlbPrimitive {
  std::size_t material = 0;
  std::vector<std::uint32_t> indices;
  /// The mesh's vertex for each vertex of a primitive with normals. Empty: the primitive has no
  /// normals, and its indices are those of the mesh.
  std::vector<std::uint32_t> vertices;

  [[nodiscard]] bool has_normals() const { return !vertices.empty(); }
};

/// In order of the materials, flat triangles before those that have a normal at all three corners.
/// Leaves out primitives without triangles.
std::vector<GlbPrimitive> split_into_primitives(const Mesh& mesh, std::size_t material_count);

}  // namespace dapple
