// Which triangles of a mesh lie in which texels. In: texture coordinates of the corners. Out: the
// covered texels with their triangles, and the parts of these inside a texel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// A convex polygon: a triangle cut by the four sides of a texel.
struct TexelPolygon {
  static constexpr std::size_t kMaxCorners = 7;
  std::array<V2f, kMaxCorners> corners;  ///< in texels
  std::size_t count = 0;
  [[nodiscard]] float area() const;
};

/// The part of the triangle `uv`, three corners in [0,1]^2, that lies in texel (x, y) of a
/// `size` x `size` texture.
TexelPolygon clip_to_texel(const V2f* uv, std::uint32_t size, std::uint32_t x, std::uint32_t y);

/// Whether a triangle is large enough in the texture to cover texels.
bool has_texel_area(const V2f* uv, std::uint32_t size);

/// Covered texels of a mesh.
struct TexelCover {
  std::vector<std::uint32_t> texel;  ///< y * size + x, increasing
  std::vector<std::uint32_t> first;  ///< of each texel, into `triangles`; one more at the end
  std::vector<std::uint32_t> triangles;
};

/// `corners`: three for each triangle. Triangles without an area in the texture cover nothing.
/// Coordinates outside [0,1] cover nothing.
TexelCover cover_texels(std::span<const V2f> corners, std::uint32_t size);

}  // namespace dapple
