/* The 8-wide BVH node, two cache lines, and how its quantized boxes are decoded. Object
   BVHs (leaves: triangles, or segments of strands) and the top-level BVH (leaves: instances) use the same node. */
#ifndef DAPPLE_SHARED_BVH_NODE_H
#define DAPPLE_SHARED_BVH_NODE_H

#include "dapple/shared/language.h"

#ifndef __OPENCL_VERSION__
namespace dapple {
#endif

#define DAPPLE_BVH_WIDTH 8

/* Entries of the traversal stack; the builder refuses trees that could need more. */
#define DAPPLE_STACK_SIZE 192

/* Child c spans origin + lower[axis][c] * 2^e .. origin + upper[axis][c] * 2^e per axis.
   An empty slot has lower 255 and upper 0. Inner children lie one after the other from
   child_base, in slot order. Leaf children own primitives: slot c those from the leaf end of
   c - 1 (0 for c = 0) up to its own, counted from prim_base; inner and empty slots own none. */
typedef struct DAPPLE_CACHE_ALIGNED BvhNode {
  float origin[3];
  uchar exponent[3];     /* biased by 127, as in a float: scale = 2^(exponent - 127) */
  uchar inner_mask;      /* bit c: child c is a node */
  uint child_base;       /* index of the first inner child's node */
  uint prim_base;        /* first block, see below (objects), or first instance (top level) */
  uchar lower[3][8];
  uchar upper[3][8];
  uchar depth[3][8];       /* optical depth of child c's quantized box along each axis */
  uchar leaf_end[8];       /* bits 0 to 5: where its primitives end; 6 and 7: mass concentration */
  schar correlation[3][8]; /* of its normals' components xy, yz, zx; codes: opacity.h, variance */
} BvhNode;

/* A node's prim_base with this bit counts segment blocks, all of an object's nodes having it, else
   triangle blocks. So it does in a block's index, and in the number of a segment that was hit. */
#define DAPPLE_SEGMENTS 0x80000000u

DAPPLE_FUNCTION uint bvh_block_index(uint block) { return block & ~DAPPLE_SEGMENTS; }

DAPPLE_FUNCTION float bvh_scale(uchar exponent) {
  return dapple_bits_to_float((uint)exponent << 23);
}

#define DAPPLE_MAX_PRIMITIVES 63 /* a node owns */

DAPPLE_FUNCTION uint bvh_leaf_end(DAPPLE_GLOBAL const uchar* leaf_end, uint slot) {
  return (uint)leaf_end[slot] & 63u;
}

DAPPLE_FUNCTION uint bvh_leaf_begin(DAPPLE_GLOBAL const uchar* leaf_end, uint slot) {
  return slot == 0u ? 0u : bvh_leaf_end(leaf_end, slot - 1u);
}

/* How far what is in child `slot` gathers around its middle, [0,1]: centre_weight(). */
DAPPLE_FUNCTION float bvh_mass_concentration(DAPPLE_GLOBAL const uchar* leaf_end, uint slot) {
  return (float)(leaf_end[slot] >> 6) * (1.0f / 3.0f);
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(BvhNode) == 128);
}  // namespace dapple
#endif

#endif
