// The closed parts of a mesh: boxes, trunks, walls with a thickness; not leaves, cards or terrains.
// In: a mesh and which of its triangles are opaque. Out: the closed part of each triangle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bvh/opacity/opaque_texels.hpp"
#include "dapple/scene.hpp"

namespace dapple {

struct ClosedParts {
  static constexpr std::uint32_t kOpen = ~0u;
  std::vector<std::uint32_t> of_triangle;  ///< kOpen: of no closed part
  std::size_t count = 0;
};

/// Parts are opaque triangles that edges join; vertices at one position are one. A part is closed
/// if most of its edges have a triangle on both sides, and its area vectors nearly cancel: their
/// sum is zero over a closed surface. So tubes whose ends are open count as closed, if they are
/// much longer than wide. Linear but for sorts.
ClosedParts closed_parts(const Mesh& mesh, const std::vector<bool>& opaque);

/// Whether each triangle of a mesh is opaque all over.
std::vector<bool> opaque_triangles(const Scene& scene, const OpaqueTexels& texels,
                                   const Mesh& mesh);

}  // namespace dapple
