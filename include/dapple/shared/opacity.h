/* Directional opacity of a box: three axis opacities, stored in 8 bits each, and the
   model that turns them into an opacity along any direction. */
#ifndef DAPPLE_SHARED_OPACITY_H
#define DAPPLE_SHARED_OPACITY_H

#include "language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
using std::exp;
using std::fmin;
using std::log;
using std::sqrt;
#endif

/* A code c in 0..255 means opacity (c / 255)^2: thin nodes don't round to nothing. */
DAPPLE_FUNCTION float opacity_decode(uchar code) {
  const float root = (float)code * (1.0f / 255.0f);
  return root * root;
}

/* Between these mean opacities the model goes from a sparse set of silhouettes, whose
   areas add up as an ellipsoid, to a filled box, as opaque from its corners as from its
   faces. */
#define DAPPLE_SPARSE_OPACITY 0.60f
#define DAPPLE_FILLED_OPACITY 0.95f

/* Transmittances below this count as none, so that optical depths stay finite. */
#define DAPPLE_LEAST_TRANSMITTANCE 1e-4f

/* Chords are not measured in boxes whose mean chord is below this part of the distance:
   their length would be rounding. */
#define DAPPLE_THINNEST 3e-5f

/* Optical depth of a box along a direction. facing_k = (projected area along axis k) *
   |direction_k|, opacity_k in [0,1] the mean opacity seen along axis k.
   Ellipsoid of occluding areas: SGGX (Heitz et al., "The SGGX Microflake
   Distribution", 2015), without its off-diagonal terms. */
DAPPLE_FUNCTION float opacity_depth(float opacity_x, float opacity_y, float opacity_z,
                                    float facing_x, float facing_y, float facing_z) {
  const float facing = facing_x + facing_y + facing_z;
  const float area_x = opacity_x * facing_x;
  const float area_y = opacity_y * facing_y;
  const float area_z = opacity_z * facing_z;
  const float inverse = 1.0f / (facing + 1e-37f);
  const float ellipsoid =
      sqrt(area_x * area_x + area_y * area_y + area_z * area_z) * inverse;
  const float mean = (area_x + area_y + area_z) * inverse;
  const float sparse = -log(1.0f - ellipsoid > DAPPLE_LEAST_TRANSMITTANCE
                                ? 1.0f - ellipsoid : DAPPLE_LEAST_TRANSMITTANCE);
  const float filled = -log(1.0f - mean > DAPPLE_LEAST_TRANSMITTANCE
                                ? 1.0f - mean : DAPPLE_LEAST_TRANSMITTANCE);
  float blend = (mean - DAPPLE_SPARSE_OPACITY) /
                (DAPPLE_FILLED_OPACITY - DAPPLE_SPARSE_OPACITY);
  blend = blend < 0.0f ? 0.0f : blend > 1.0f ? 1.0f : blend;
  return sparse + blend * (filled - sparse);
}

#ifndef __OPENCL_VERSION__
}  // namespace dapple
#endif

#endif
