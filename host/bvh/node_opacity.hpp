// What a node stores of what is in it, before it becomes bytes: opacity along the axes, and
// how the normals of its surfaces lie.
#pragma once

#include <array>
#include <cstddef>

#include "dapple/scene.hpp"

namespace dapple {

/// Second moments of normals, weighted by area and opacity: xx, yy, zz, xy, yz, zx. Of
/// everything in a node they are the sum of its children's.
struct NormalMoments {
  std::array<float, 6> sum{};

  /// A surface with area vector `normal` (its length is any multiple of the area).
  void add(const V3f& normal, float opacity);
  void add(const NormalMoments& other);
  /// The moments after the surfaces are placed: area vectors turn by the matrix' cofactors.
  [[nodiscard]] NormalMoments placed(const M44f& to_world) const;
  /// Correlations xy, yz, zx of the normals' components, [-1,1]; 0 where one is always 0.
  [[nodiscard]] V3f correlation() const;
};

struct NodeOpacity {
  V3f axes{0, 0, 0};  ///< opacity along x, y, z, [0,1]
  NormalMoments normals;
  std::size_t triangles = 0;  ///< in the whole subtree; 0: many
};

/// -log(1 - opacity), at most the greatest depth that a node can store.
float depth_of(float opacity);

/// Factor on the depths of a box of `size` with few triangles. Depths suit many surfaces one
/// behind the other; a single one hides its projected area, which is less between the axes.
/// The factor makes the hidden area right in the mean over all directions; it fades from one
/// triangle to 64.
float single_layer_factor(const NodeOpacity& opacity, const V3f& size);

/// Opacity that a ray of mean chord along `direction` (any length) meets in a box of `size`:
/// the model of dapple/shared/opacity.h.
float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction);

}  // namespace dapple
