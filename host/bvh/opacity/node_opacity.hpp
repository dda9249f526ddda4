// The opacity of a node before quantization: opacities along the axes, and the second moments of
// the normals of its surfaces. Heitz et al., "The SGGX Microflake Distribution", 2015.
#pragma once

#include <array>
#include <cstddef>

#include "dapple/scene.hpp"

namespace dapple {

/// Second moments of normals, weighted by area and opacity: xx, yy, zz, xy, yz, zx. The moments of
/// a node are the sums of the moments of its children.
struct NormalMoments {
  std::array<float, 6> sum{};

  /// Adds a surface with area vector `normal`, whose length is any multiple of the area.
  void add(const V3f& normal, float opacity);
  /// Adds half of the lateral surface of a cylinder: the half that is visible from one direction.
  /// The length of `axis` is the length of the cylinder.
  void add_cylinder(const V3f& axis, float radius, float opacity);
  void add(const NormalMoments& other);
  /// Returns the moments after a transform: the cofactor matrix transforms area vectors.
  [[nodiscard]] NormalMoments placed(const M44f& to_world) const;
  /// Correlations xy, yz, zx of the normals' components, [-1,1]; 0 if a component is always 0.
  [[nodiscard]] V3f correlation() const;
};

/// Where the mass of a box is: its opacity is proportional to centre_weight() of
/// dapple/shared/opacity.h.
struct MassShape {
  float concentration = 0;  ///< 0, 1/3, 2/3 or 1
  V3f pole{0, 0, 0};        ///< from the centre, in half sizes: -3/4, -1/4, 1/4 or 3/4 each
  /// Mean of centre_weight() over the box: above 1 where its minimum cuts much off.
  [[nodiscard]] float mean_weight() const;
  /// Mean of the positions of the opacity, in half sizes.
  [[nodiscard]] V3f centroid() const { return pole * (2.0f / 3.0f * concentration); }
};

struct NodeOpacity {
  V3f axes{0, 0, 0};  ///< opacity along x, y, z, [0,1]
  NormalMoments normals;
  float clumping = 0;  ///< MapStatistics::clumping
  MassShape mass = {};
  bool wall = false;  ///< is_wall() of bvh/opacity/wall.hpp: traversal opens it
};

/// Returns the shape that a node can store nearest to these moments, by least squares. Means over
/// the occluders, seen along the axes: `centroid`, of their positions from the centre of the box;
/// `off_centre`, of their squared distances from it. Both in half sizes of the box.
MassShape mass_shape_of(const V3f& centroid, float off_centre);

/// Returns the variance class of a box's opacity, as nodes store it: dapple/shared/opacity.h.
unsigned variance_class(const NodeOpacity& opacity);

/// Returns the optical depth -log(1 - opacity), at most the maximum that a node can store.
float depth_of(float opacity);

/// Returns the variance of the lengths of a box's chords along a direction, divided by their
/// squared mean, [0, 1/2]. `facing`: projected areas of the faces of the box along the direction.
float chord_variance(const V3f& facing);

/// Returns the mean opacity of a box of `size` for rays along `direction` (any length). Clumping
/// interpolates between two models. 0: the surfaces are evenly distributed, and the opacity follows
/// from the optical depths. 1: the surfaces form a clump, and the opacity is the projected area of
/// the clump, which is smaller in directions between the axes.
float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction);

/// Returns the factor on the optical depths along the axes, [0.6, 1.6]. With it, the opacity by
/// box_depth(), chord_depth() and centre_weight() of dapple/shared/opacity.h agrees with
/// opacity_along() in the mean over all directions and chords, to the accuracy of one Newton step.
float clumping_factor(const NodeOpacity& opacity, const V3f& size);

}  // namespace dapple
