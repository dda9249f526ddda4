/* Directional opacity of a box. In: optical depths along the three axes and the correlations of the
   normals of its surfaces, one byte each. Out: the optical depth along any ray. Opacity is
   1 - exp(-depth). Heitz et al., "The SGGX Microflake Distribution", 2015. */
#ifndef DAPPLE_SHARED_OPACITY_H
#define DAPPLE_SHARED_OPACITY_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
using std::sqrt;
#endif

/* The least transmittance of a node: larger opacities count as 1 - this. Depths are stored as parts
   of -log(1e-4). */
#define DAPPLE_MIN_TRANSMITTANCE 1e-4f
#define DAPPLE_MAX_DEPTH 9.2103404f

/* Chords are not computed for boxes whose mean chord is below this fraction of the distance:
   rounding would dominate the length. */
#define DAPPLE_MIN_THICKNESS 3e-5f

/* Mean of off_centre, the squared distance from the box's centre to the middle of a ray's chord:
   the sum of squares of its coordinates in half sizes of the box. The mean over uniformly
   distributed rays is 2/3 for rays along an axis and 0.70 for diagonal rays. centre_weight() is
   never below DAPPLE_MIN_CENTRE_WEIGHT. */
#define DAPPLE_MEAN_OFF_CENTRE 0.68f
#define DAPPLE_MIN_CENTRE_WEIGHT 0.1f

/* Between these two depths a box gradually counts as solid: the length of the ray's chord matters
   less and less, so that solid boxes do not leak light at their edges. */
#define DAPPLE_SPARSE_DEPTH 1.0f
#define DAPPLE_FILLED_DEPTH 3.0f

/* How many times the area of a leaf a footprint must have to cover it: to open a leaf costs one block
   only (experiments 234, 241 and 245). */
#define DAPPLE_LEAF_COVERING 4.0f

/* Share of a ray's footprint over which textures of occluders are averaged (experiments 235, 242 and
   246). */
#define DAPPLE_TEXTURE_FOOTPRINT 0.25f

/* Transmittances below this are reported as 0, and their rays end. It is below 1e-4, the tolerance for
   exact rays. */
#define DAPPLE_OPAQUE_ENOUGH 5e-5f

/* A ray that leaves a box before this part of t_max does not end inside of it: t_max less two
   roundings. */
#define DAPPLE_BEFORE_END 0.999999f

/* Code c, 0 to 254, means (c / 255)^2 of DAPPLE_MAX_DEPTH, so that small depths do not round to 0. Of
   the codes of a child along x, 255 says that it is a wall: kernels/opacity/footprint.clh. */
DAPPLE_FUNCTION float decode_depth(uchar code) {
  const float root = (float)code * (1.0f / 255.0f);
  return root * root * DAPPLE_MAX_DEPTH;
}

/* Variance class of a child's opacity, stored in the lowest bits of its three correlations. The
   projection of the box along each axis is divided into 16 x 16 cells. Class c, 0 to 6: the
   opacities of the cells deviate from their mean by at most 2^(c/2 - 8) (rms), and the squared mean
   is not larger either; class 7: all others. */
#define DAPPLE_NOT_UNIFORM 7u
#define DAPPLE_MIN_VARIANCE 1.52587890625e-5f /* 2^-16 */

/* The upper five bits, -15 to 15. */
#define DAPPLE_CORRELATION_MASK (-8)
#define DAPPLE_CORRELATION_STEP (1.0f / 120.0f)

DAPPLE_FUNCTION float decode_correlation(schar code) {
  return (float)(code & DAPPLE_CORRELATION_MASK) * DAPPLE_CORRELATION_STEP;
}

/* Whether the footprint of a ray covers a box that the ray enters and leaves at these distances, and
   the box's depth is used in place of its contents. needed: projected area of the box times its
   covering ratio (kernels/opacity/footprint.clh). A box that holds either end of the ray is never
   covered. This is the rule where traversal stops; for eight boxes at once it is covered_children()
   of footprint.clh and covered_for() of kernels/occlusion/packet_node.clh. */
DAPPLE_FUNCTION bool footprint_covers(float needed, float first_area, float solid_angle, float enter,
                                      float leave, float t_max) {
  const float middle = 0.5f * (enter + leave);
  return needed < first_area + solid_angle * middle * middle && enter > 0.0f &&
         leave < t_max * DAPPLE_BEFORE_END;
}

/* Mean optical depth of a box along a direction. facing_k = (projected area along axis k) *
   |direction_k|, depth_k along axis k, correlation_ij in [-1,1] times the sign of
   direction_i * direction_j. The depths times areas span an ellipsoid whose off-diagonal
   terms follow the normals: SGGX (Heitz et al., "The SGGX Microflake Distribution", 2015)
   with optical depths in place of projected areas, so that filled boxes stay filled. */
DAPPLE_FUNCTION float box_depth(float depth_x, float depth_y, float depth_z, float correlation_xy,
                                float correlation_yz, float correlation_zx, float facing_x,
                                float facing_y, float facing_z) {
  /* Parts of the area first: squares of areas exceed a float where boxes have 1e10 units. */
  const float per_area = 1.0f / (facing_x + facing_y + facing_z + 1e-37f);
  const float x = depth_x * (facing_x * per_area);
  const float y = depth_y * (facing_y * per_area);
  const float z = depth_z * (facing_z * per_area);
  const float square =
      x * x + y * y + z * z +
      2.0f * (correlation_xy * x * y + correlation_yz * y * z + correlation_zx * z * x);
  return sqrt(square > 0.0f ? square : 0.0f);
}

/* Optical depth of a ray whose chord is `chord` times the mean chord of the box. */
DAPPLE_FUNCTION float chord_depth(float depth, float chord) {
  float filled = (depth - DAPPLE_SPARSE_DEPTH) / (DAPPLE_FILLED_DEPTH - DAPPLE_SPARSE_DEPTH);
  filled = filled < 0.0f ? 0.0f : filled > 1.0f ? 1.0f : filled;
  return depth * (chord + filled * (1.0f - chord));
}

/* Factor of the optical depth of a ray for the place of the mass: boxes hold less far from their
   mass pole. off_pole: squared distance from the pole to the middle of the ray's chord;
   pole_square: from the pole to the centre of the box; both in half sizes. The mean over all rays
   is 1: DAPPLE_MEAN_OFF_CENTRE + pole_square is the mean of off_pole. */
DAPPLE_FUNCTION float centre_weight(float mass_concentration, float off_pole, float pole_square) {
  const float weight =
      1.0f + mass_concentration * (DAPPLE_MEAN_OFF_CENTRE + pole_square - off_pole);
  return weight > DAPPLE_MIN_CENTRE_WEIGHT ? weight : DAPPLE_MIN_CENTRE_WEIGHT;
}

#ifndef __OPENCL_VERSION__
}  // namespace dapple
#endif

#endif
