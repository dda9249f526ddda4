// A mesh as exporters of flat shading write it. In: a mesh. Out: the same triangles, whose vertices
// are not shared.
#pragma once

#include <cstdint>

#include "dapple/scene.hpp"

namespace dapple::test {

/// Each triangle has three vertices of its own.
inline Mesh with_split_vertices(const Mesh& mesh) {
  Mesh split;
  split.materials = mesh.materials;
  for (const std::uint32_t index : mesh.indices) {
    split.indices.push_back(static_cast<std::uint32_t>(split.positions.size()));
    split.positions.push_back(mesh.positions[index]);
  }
  return split;
}

}  // namespace dapple::test
