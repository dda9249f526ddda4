/* Blocks of segments of strands, and functions that decode them.
   host/bvh/storage/segment_block.cpp encodes them.

   A segment is the side of a cone (an axis between two end points, a radius at each) between two
   planes through the end points. Two consecutive segments share the plane that bisects the angle
   between them, so that they leave no gap and do not overlap. A ray hits a segment where it enters:
   once for each crossing of the strand, and never the strand that it starts from. These are the
   front-facing hits of Embree's round linear curves. A strand ends in half a sphere (a cap). */
#ifndef DAPPLE_SHARED_SEGMENT_BLOCK_H
#define DAPPLE_SHARED_SEGMENT_BLOCK_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

/* Eight segments, one in each vector lane, in three cache lines. End points are on a grid that
   belongs to the block. Unused lanes are all zeros, and no leaf owns them. */
typedef struct DAPPLE_CACHE_ALIGNED SegmentBlock {
  float origin[3];  /* of the grid */
  uchar exponent;   /* of the grid's step, biased by 127 as in a float */
  uchar begin_caps; /* bit l: segment l is the first of its strand */
  uchar end_caps;   /* bit l: segment l is the last of its strand */
  uchar spare;
  float radius;       /* of code 255, metres in object space; of code c (c / 255)^2 of it */
  float opacity;      /* the same, [0,1] */
  ushort begin[3][8]; /* steps from the origin */
  ushort end[3][8];
  schar begin_plane[3][8]; /* normals of any length, towards the end of the strand */
  schar end_plane[3][8];
  uchar begin_radius[8];
  uchar end_radius[8];
  uchar opacity_code[8];
} SegmentBlock;

#define DAPPLE_MAX_GRID_CODE 65535
#define DAPPLE_MAX_PLANE_CODE 127

DAPPLE_FUNCTION float segment_step(DAPPLE_GLOBAL const SegmentBlock* block) {
  return dapple_bits_to_float((uint)block->exponent << 23);
}

/* Factors of the squares of the codes of radii and opacities: squares, so that a thin segment beside
   a thick one has a radius. */
DAPPLE_FUNCTION float segment_radius_step(DAPPLE_GLOBAL const SegmentBlock* block) {
  return block->radius * (1.0f / (255.0f * 255.0f));
}
DAPPLE_FUNCTION float segment_opacity_step(DAPPLE_GLOBAL const SegmentBlock* block) {
  return block->opacity * (1.0f / (255.0f * 255.0f));
}

DAPPLE_FUNCTION float segment_radius(uchar code, float radius_step) {
  return (float)code * (float)code * radius_step;
}
/* At most 1, in spite of rounding. */
DAPPLE_FUNCTION float segment_opacity_of(DAPPLE_GLOBAL const SegmentBlock* block, uint lane) {
  const float code = (float)block->opacity_code[lane];
  const float opacity = code * code * segment_opacity_step(block);
  return opacity < 1.0f ? opacity : 1.0f;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(SegmentBlock) == 192);
}  // namespace dapple
#endif

#endif
