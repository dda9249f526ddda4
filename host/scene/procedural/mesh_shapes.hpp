// The shapes that procedural scenes consist of: quads, squares, leaf blades and tapered tubes.
// In: corners, axes and radii in metres; out: vertices, indices and materials appended to a Mesh,
// and normals if it has any. Every triangle has an area.
#pragma once

#include <cstdint>
#include <span>

#include "dapple/scene.hpp"

namespace dapple {

/// Returns one of the unit vectors perpendicular to `direction`, whose length must not be zero.
V3f perpendicular(V3f direction);

/// Appends two triangles a-b-c, a-c-d.
void append_quad(Mesh& mesh, V3f a, V3f b, V3f c, V3f d, std::uint32_t material);

/// Appends a horizontal square facing up, centred at (0, y, 0).
void append_square(Mesh& mesh, float side, float y, std::uint32_t material);

/// Tubes with so many sides or more have the normals of a cylinder. At the edge of a thinner one,
/// these differ so much from its faces that rays about them would start into the tube.
inline constexpr int kSmoothSides = 5;

/// Appends a tube through `points` (two or more) that is open at its beginning and ends in a point
/// at the last one. Front sides are outside. Its radius at points[i] is radii[i]; the last radius
/// is not used. Tubes with kSmoothSides or more have normals, so that they look round.
void append_tube(Mesh& mesh, std::span<const V3f> points, std::span<const float> radii, int sides,
                 std::uint32_t material);

/// Appends the triangles of a grid of (rows + 1) * (columns + 1) vertices, row by row from vertex
/// `first`. Their front side is where the direction of rows is to the left of that of columns.
void append_grid_triangles(Mesh& mesh, std::uint32_t first, int rows, int columns,
                           std::uint32_t material);

/// Gives the vertices from `first_vertex` on the normals of the surface of the triangles from
/// `first_triangle` on: means of their faces, weighted by area.
void smooth_normals(Mesh& mesh, std::size_t first_vertex, std::size_t first_triangle);

/// 0 up to x = 0, 1 from x = 1 on, and a cubic between, without kinks.
inline float smooth_step(float x) {
  if (x <= 0) return 0;
  return x < 1 ? x * x * (3 - 2 * x) : 1;
}

/// Cosine and sine of the `i`-th azimuth of a spiral: turned by the golden angle each time, from
/// `offset`, radians.
V2f spiral_azimuth(int i, float offset);

/// The width of a broad leaf over its length.
inline constexpr float kBladeWidth = 0.55f;
/// Area of a broad leaf divided by the square of its length, without the fold.
inline constexpr float kBladeArea = kBladeWidth / 2;

/// One leaf: a rhombus from `base` to `base + axis * length`. It is slightly folded along its
/// midrib, the edge that its two triangles share.
struct Blade {
  V3f base;
  V3f axis;    ///< unit
  V3f normal;  ///< unit, at right angles to `axis`
  float length = 0;
  float width = kBladeWidth;  ///< over the length
};

/// Appends memory for `count` blades to a mesh; set() fills it in any order.
class BladeRange {
 public:
  BladeRange(Mesh& mesh, std::size_t count, std::uint32_t material);
  /// Safe to call from several threads for different `i`.
  void set(std::size_t i, const Blade& blade);

 private:
  Mesh& mesh_;
  std::size_t first_vertex_;
  std::size_t first_triangle_;
  std::uint32_t material_;
};

}  // namespace dapple
