// The opacity of a node before quantization: opacities along the axes, and the second moments of
// the normals of its surfaces (SGGX, Heitz et al. 2015).
#pragma once

#include <array>
#include <cstddef>

#include "dapple/scene.hpp"

namespace dapple {

/// Second moments of normals, weighted by area and opacity: xx, yy, zz, xy, yz, zx. Those of a node
/// are the sum over its children.
struct NormalMoments {
  std::array<float, 6> sum{};

  /// Adds a surface with area vector `normal`, whose length is any multiple of the area.
  void add(const V3f& normal, float opacity);
  /// The side of a cylinder around `axis`, half of it: what is seen from anywhere.
  void add_cylinder(const V3f& axis, float radius, float opacity);
  void add(const NormalMoments& other);
  /// The moments after the surfaces are placed: area vectors turn by the matrix' cofactors.
  [[nodiscard]] NormalMoments placed(const M44f& to_world) const;
  /// Correlations xy, yz, zx of the normals' components, [-1,1]; 0 where one is always 0.
  [[nodiscard]] V3f correlation() const;
};

struct NodeOpacity {
  V3f axes{0, 0, 0};  ///< opacity along x, y, z, [0,1]
  NormalMoments normals;
  float clumping = 0;            ///< CoverageMap::clumping()
  float mass_concentration = 0;  ///< mass_concentration_of(), [0,1]
  std::size_t triangles = 0;     ///< in the whole subtree; 0: many
};

/// The mass concentration that makes centre_weight() of dapple/shared/opacity.h fit: from the mean
/// squared distance of what hides from the centre of the box, seen along the axes, in half
/// sizes. 2/3 and more, as of things that fill the box evenly or stay away from its middle: 0.
float mass_concentration_of(float off_centre);

/// Variance class of a box's opacity, as nodes store it: dapple/shared/opacity.h.
unsigned variance_class(const NodeOpacity& opacity);

/// -log(1 - opacity), at most the greatest depth that a node can store.
float depth_of(float opacity);

/// Variance of a box's chords along a direction over their squared mean, [0, 1/2]. Of the box
/// only its faces' projected areas along the direction matter.
float chord_variance(const V3f& facing);

/// Mean opacity that rays along `direction` (any length) meet in a box of `size`. Surfaces
/// that lie evenly, one behind the other, hide what their depths say; a clump hides its
/// projected area, which is less between the axes. Clumping goes from one to the other.
float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction);

/// Factor on the depths along the axes with which rays that meet box_depth(), chord_depth() and
/// centre_weight() of dapple/shared/opacity.h are stopped as opacity_along() says in the mean
/// over all directions and ways through the box.
float clumping_factor(const NodeOpacity& opacity, const V3f& size);

}  // namespace dapple
