// Which part of a textured triangle hides anything. Cards are leaves on nothing: the game pine's
// are half empty, and boxes around what is there have two thirds of the triangles' surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "bvh/texel_maxima.hpp"
#include "bvh/textured_triangle.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// A convex part of a triangle, by the barycentrics of edge1 and edge2: the least and the most of
/// u, v, u + v and u - v. At first all of it.
struct OpaquePart {
  std::array<float, 4> least{0, 0, 0, -1}, most{1, 1, 1, 1};

  static OpaquePart nothing();
  [[nodiscard]] bool is_empty() const { return least[0] > most[0]; }
};

/// The box of a triangle's part; not empty.
Box3f part_box(const std::array<V3f, 3>& corners, const OpaquePart& part);

/// Finds the parts of textured triangles outside of which they let everything through.
class OpaqueParts {
 public:
  /// Looks through the textures that `textured` need, once each. Keeps `scene` by address.
  OpaqueParts(const Scene& scene, std::span<const TexturedTriangle> textured);

  /// Found by halving edges five times at most, so to 1/32 of them.
  [[nodiscard]] OpaquePart find(const TexturedTriangle& triangle) const;

 private:
  const Scene& scene_;
  std::vector<std::pair<int, TexelMaxima>> textures_;  ///< by index, ascending
};

}  // namespace dapple
