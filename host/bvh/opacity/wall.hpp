// Finds walls: nodes with a part of an opaque surface that continues beyond them. Their neighbours
// close the gaps in their boxes, so light would leak if node opacities were multiplied. Traversal
// always opens such nodes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/opacity/node_opacity.hpp"
#include "bvh/opacity/opaque_triangles.hpp"

namespace dapple {

/// Finds the triangles of the mesh that lie inside an opaque surface: around each corner opaque
/// triangles close a ring. Corners at equal positions count as one: `welded`, of welded_vertices().
/// A leaf has no such triangles, a wall, a trunk or the ground has few others; where these make up
/// most of a connected surface, its rim counts, too. Returns for each of them the mean chord of
/// what its connected surface encloses, 4 volumes / area (Cauchy), in metres and above 0: of a tube
/// the diameter. It does not matter which side the triangles face. 0 for other triangles of the
/// mesh; empty if there are none. Almost linear in the triangles.
std::vector<float> interior_triangles(const OpaqueTriangles& opaque,
                                      std::span<const std::uint32_t> welded);

/// Sums over the triangles of a node, by which is_wall() decides.
struct WallAreas {
  V3f vector{0, 0, 0};  ///< of the area vectors of interior_triangles(), square metres
  float interior = 0;   ///< area of interior_triangles()
  float chords = 0;     ///< of these, area times mean chord
  float all = 0;        ///< area of all surfaces, times their opacities

  /// Adds a triangle with area vector `area`. `chord`: of interior_triangles().
  void add(const V3f& area, float opacity, float chord);
  void add(const WallAreas& areas);
};

/// Whether a continuing opaque surface covers a part of the node as seen along its normal (as a
/// wall with ivy), or most of the node is such a surface of which it holds one side (as a wall, or
/// a part of a trunk), or which is flat (as a thick wall with both sides), or which encloses more
/// than the node (as a cave, of which it holds a pillar). A whole twig is none of these: light
/// passes beside it. `box`: of the node.
bool is_wall(const WallAreas& areas, const NormalMoments& normals, const Box3f& box);

}  // namespace dapple
