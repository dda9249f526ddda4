// Finds walls: nodes with a part of an opaque surface that continues beyond them. Their neighbours
// close the gaps in their boxes, so light would leak if node opacities were multiplied. Traversal
// always opens such nodes.
#pragma once

#include <vector>

#include "bvh/opacity/node_opacity.hpp"
#include "bvh/opacity/opaque_triangles.hpp"

namespace dapple {

/// Returns which triangles of the mesh lie inside an opaque surface: around each corner opaque
/// triangles close a ring. Corners at equal positions count as one. A leaf has no such triangles, a
/// wall, a trunk or the ground has few others; where these make up most of a connected surface, its
/// rim counts, too. One entry a triangle of the mesh; empty if there are none. Almost linear in the
/// triangles.
std::vector<bool> interior_triangles(const OpaqueTriangles& opaque);

/// Sums over the triangles of a node, by which is_wall() decides.
struct WallAreas {
  V3f vector{0, 0, 0};  ///< of the area vectors of interior_triangles(), square metres
  float interior = 0;   ///< area of interior_triangles()
  float all = 0;        ///< area of all surfaces, times their opacities

  /// Adds a triangle with area vector `area`.
  void add(const V3f& area, float opacity, bool is_interior);
  void add(const WallAreas& areas);
};

/// Whether most of the node is a continuing opaque surface of which it holds one side (as a wall,
/// or a part of a trunk) or which is flat (as a thick wall with both sides). A whole twig is
/// neither: light passes beside it.
bool is_wall(const WallAreas& areas, const NormalMoments& normals);

}  // namespace dapple
