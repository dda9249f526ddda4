/* The 8-wide BVH node of two cache lines with quantized boxes, and functions that decode it. Object
   BVHs (leaves: triangles, or segments of strands) and the top-level BVH (leaves: instances) use
   the same node. */
#ifndef DAPPLE_SHARED_BVH_NODE_H
#define DAPPLE_SHARED_BVH_NODE_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

#define DAPPLE_BVH_WIDTH 8

/* Entries of the traversal stack. The builder throws an Error for BVHs that could need more. */
#define DAPPLE_STACK_SIZE 192

/* The box of child c is, on each axis, origin + lower[axis][c] * 2^e .. origin + upper[axis][c] *
   2^e. An empty slot has lower 255 and upper 0. Inner children are consecutive nodes from
   child_base on, in slot order. A leaf child in slot c owns the primitives from the leaf end of
   slot c - 1 (bvh_first_lane() for c = 0) to its own leaf end, counted from lane 0 of the
   block that prim_base names; bvh_block() is the block of one. Inner and empty slots own none. */
typedef struct DAPPLE_CACHE_ALIGNED BvhNode {
  float origin[3];
  uchar exponent[3]; /* biased by 127, as in a float: scale = 2^(exponent - 127) */
  uchar inner_mask;  /* bit c: child c is a node */
  uint child_base;   /* index of the first inner child's node */
  uint prim_base;    /* first block and lane, see below; or first instance (top level) */
  uchar lower[3][8];
  uchar upper[3][8];
  uchar depth[3][8];       /* optical depth of child c's quantized box along each axis */
  uchar leaf_end[8];       /* bits 0 to 5: end of child c's primitives; 6, 7: mass concentration */
  schar correlation[3][8]; /* bits 3 to 7: of its normals' components xy, yz, zx; 1, 2: mass pole
                              along x, y, z; 0: of its variance class */
} BvhNode;

/* This bit of prim_base is set if the object consists of segments: prim_base is then the index of a
   segment block, otherwise of a triangle block. The bit has the same meaning in the index of a
   block and in the number of a hit primitive. */
#define DAPPLE_SEGMENTS 0x80000000u

/* Nodes share blocks: bits 28 to 30 of prim_base are the first lane that is the node's. */
#define DAPPLE_FIRST_LANE_SHIFT 28u
#define DAPPLE_MAX_BLOCKS (1u << DAPPLE_FIRST_LANE_SHIFT)

DAPPLE_FUNCTION uint bvh_first_lane(uint prim_base) {
  return prim_base >> DAPPLE_FIRST_LANE_SHIFT & 7u;
}

DAPPLE_FUNCTION uint bvh_block_index(uint block) { return block & (DAPPLE_MAX_BLOCKS - 1u); }

/* The block of a primitive that is counted as leaf ends are; with the bit DAPPLE_SEGMENTS. */
DAPPLE_FUNCTION uint bvh_block(uint prim_base, uint primitive) {
  return (prim_base & (DAPPLE_SEGMENTS | (DAPPLE_MAX_BLOCKS - 1u))) + (primitive >> 3);
}

DAPPLE_FUNCTION float bvh_scale(uchar exponent) {
  return dapple_bits_to_float((uint)exponent << 23);
}

#define DAPPLE_MAX_PRIMITIVES 63 /* of the leaf children of one node, with lanes before the first */

DAPPLE_FUNCTION uint bvh_leaf_end(DAPPLE_GLOBAL const uchar* leaf_end, uint slot) {
  return (uint)leaf_end[slot] & 63u;
}

DAPPLE_FUNCTION uint bvh_leaf_begin(DAPPLE_GLOBAL const BvhNode* node, uint slot) {
  return slot == 0u ? bvh_first_lane(node->prim_base) : bvh_leaf_end(node->leaf_end, slot - 1u);
}

/* Place of the mass pole of child `slot` along an axis, from the centre of its box, in half sizes:
   -3/4, -1/4, 1/4 or 3/4. */
DAPPLE_FUNCTION float bvh_mass_pole(DAPPLE_GLOBAL const schar (*correlation)[8], uint axis,
                                    uint slot) {
  return (float)(((uint)correlation[axis][slot] >> 1) & 3u) * 0.5f - 0.75f;
}

/* A child whose depth code along x has this value is a wall (host/bvh/opacity/wall.hpp): it is
   never covered, and its opacity is not used. */
#define DAPPLE_WALL_DEPTH 255

DAPPLE_FUNCTION bool bvh_is_wall(DAPPLE_GLOBAL const uchar (*depth)[8], uint slot) {
  return depth[0][slot] == DAPPLE_WALL_DEPTH;
}

/* Mass concentration of child `slot` around its mass pole, [0,1]; for centre_weight(). */
DAPPLE_FUNCTION float bvh_mass_concentration(DAPPLE_GLOBAL const uchar* leaf_end, uint slot) {
  return (float)(leaf_end[slot] >> 6) * (1.0f / 3.0f);
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(BvhNode) == 128);
}  // namespace dapple
#endif

#endif
