// The triangles of a leaf that are drawn into its coverage map. In: triangles or strips of strands.
// Out: which of them share edges and lie side by side, so that their opacities add up, and which
// two form a parallelogram, as the halves of a card do.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dapple/scene.hpp"

namespace dapple {

/// The two axes that a map along `axis` spans: column_axis() for columns, row_axis() for rows.
inline constexpr int column_axis(int axis) { return (axis + 1) % 3; }
inline constexpr int row_axis(int axis) { return (axis + 2) % 3; }

/// A triangle to rasterize. If `opacity` is negative, cover() calls `opacity_at(triangle, u, v,
/// share)`, which returns the mean opacity around the barycentrics over `share` of the triangle's
/// area.
struct CoveringTriangle {
  V3f vertex, edge1, edge2;
  float opacity;
  bool closed = false;  ///< part of an opaque closed surface: closed_triangles()
};

/// The triangles for each axis. Triangles of meshes are the same for all axes; strips of strands
/// face their axis.
using Covering = std::array<std::span<const CoveringTriangle>, 3>;

/// Maximum number of triangles of a leaf for one axis: eight primitives, of which strands have two
/// triangles each.
inline constexpr std::size_t kMaxCovering = 16;

/// The edges that triangles of a leaf share.
class SharedEdges {
 public:
  explicit SharedEdges(const Covering& covering);

  /// Returns a mask: bit k is set if triangle k shares an edge with triangle `t` and lies on the
  /// opposite side of it, seen along `axis`.
  [[nodiscard]] std::uint32_t neighbours(int axis, std::size_t t) const {
    return neighbours_[axis][t];
  }
  /// Whether no triangle occludes another, seen along any axis: they lie side by side, edge to
  /// edge.
  [[nodiscard]] bool is_single_layer() const;

  /// A neighbour of like opacity with which triangle `t` forms a quad, and the corner of `t` that
  /// is opposite to the edge that they share. No triangle is in two quads.
  struct Partner {
    std::int8_t triangle = -1;  ///< below 0: there is none
    std::int8_t corner = 0;
  };
  [[nodiscard]] Partner partner(int axis, std::size_t t) const { return partners_[axis][t]; }

 private:
  /// Sets the members for these axes, a bit each, along which the same triangles are seen.
  void compare(std::span<const CoveringTriangle> triangles, unsigned axes);

  std::size_t count_;
  std::array<std::array<std::uint16_t, kMaxCovering>, 3> neighbours_{};
  std::array<std::array<Partner, kMaxCovering>, 3> partners_{};
};

/// The triangle with `corner` first: the same triangle, in the same order.
CoveringTriangle turned(const CoveringTriangle& triangle, int corner);

inline V3f corner_of(const CoveringTriangle& triangle, int corner) {
  return corner == 0 ? triangle.vertex
                     : triangle.vertex + (corner == 1 ? triangle.edge1 : triangle.edge2);
}

}  // namespace dapple
