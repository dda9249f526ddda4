// Finds closed surfaces, such as twigs, trunks and stones. Their front always occludes their back,
// so the opacity of a node must not count both.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/opacity/opaque_triangles.hpp"

namespace dapple {

/// Maximum length of the sum of a closed surface's area vectors, relative to its area: a tube with
/// an open end counts if it is five times as long as its radius.
inline constexpr double kMaxOpenArea = 0.1;

/// Returns which triangles of the mesh belong to closed surfaces: connected components of opaque
/// triangles whose sum of area vectors is short (kMaxOpenArea), so that twigs with open ends count.
/// Triangles are connected by vertices; those of open
/// components also by edges whose ends are at equal positions (`welded`, of welded_vertices()),
/// since exporters split vertices at seams and where shading is flat. One entry a triangle of the
/// mesh; empty if there are no closed surfaces.
std::vector<bool> closed_triangles(const OpaqueTriangles& opaque,
                                   std::span<const std::uint32_t> welded);

/// Projected areas along x, y, z of the surfaces in a node, each times its opacity.
struct SurfaceAreas {
  V3f front{0, 0, 0};  ///< of closed surfaces, facing the positive axis
  V3f back{0, 0, 0};   ///< of closed surfaces, facing away from it
  V3f other{0, 0, 0};

  /// Adds a surface with area vector `area`, square metres.
  void add(const V3f& area, float opacity, bool closed);
  void add(const SurfaceAreas& areas);
};

/// Returns, for two nodes seen along `axis`, the share of the smaller node that is the back of a
/// closed surface whose front is in the larger node, or the reverse, [0,1].
float enclosed_share(const SurfaceAreas& a, const SurfaceAreas& b, int axis);

}  // namespace dapple
