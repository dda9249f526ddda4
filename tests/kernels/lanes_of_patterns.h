/* Kernels that call the functions of lanes.clh and ray_sets.clh. In: patterns of sixteen bits, one an
   item, or sets of rays; out: the result of each function, and which children a packet pushes. Included
   once for each way in which lanes.clh can be compiled. */
#include "occlusion/packet_stack.clh"

__kernel void lanes_of_patterns(__global uint* found) {
  const uint pattern = get_global_id(0);
  int lanes[16];
  uint lowest = 16u;
  for (uint i = 0; i < 16u; ++i) {
    lanes[i] = pattern >> i & 1u ? -1 : 0;
    if (lanes[i] && lowest == 16u) lowest = i;
  }
  const int16 all = vload16(0, lanes);
  __global uint* to = found + 6u * pattern;
  to[0] = bits_of_16(all);
  to[1] = bits_of_lanes(all.lo) | bits_of_lanes(all.hi) << 8;
  to[2] = any_lane(all.lo);
  to[3] = any_lane(all.hi);
  to[4] = bits_of_16(lanes_of_16_bits(pattern));
  to[5] = pattern ? lowest_bit(pattern) : lowest;
}

/* Sixteen numbers an item: their floors, and their roundings to integers. */
__kernel void rounded(__global const float* numbers, __global float* floors,
                      __global long* wholes, uint items) {
  const uint item = get_global_id(0);
  if (item >= items) return;
  const float16 x = vload16(item, numbers);
  vstore16(floor_16(x), item, floors);
  vstore8(rounded_longs(x.lo), 2u * item, wholes);
  vstore8(rounded_longs(x.hi), 2u * item + 1u, wholes);
}

/* The low eight bits of `pattern` are the children that are nodes, numbered from 100 on; the high
   eight bits are the opened children. Slot s is opened by s + 1 rays. Out: 17 entries an item, the
   number of pushed nodes, eight node numbers, and eight numbers of rays. */
__kernel void children_of_patterns(__global BvhNode* nodes, __global uint* found) {
  const uint pattern = get_global_id(0);
  __global BvhNode* node = nodes + pattern;
  node->inner_mask = (uchar)(pattern & 255u);
  node->child_base = 100u;
  RaySets opened;
  for (uint slot = 0; slot < 8u; ++slot)
    opened.u[slot] = pattern >> (8u + slot) & 1u ? (1UL << (slot + 1u)) - 1UL : 0UL;
  PacketStack stack;
  start_stack(&stack);
  push_inner(node, &opened, &stack);
  __global uint* to = found + 17u * pattern;
  const uint pushed = stack.top - DAPPLE_STACK_BOTTOM;
  to[0] = pushed;
  for (uint i = 0; i < 8u; ++i) {
    to[1u + i] = i < pushed ? stack.entry[DAPPLE_STACK_BOTTOM + i] : 0u;
    to[9u + i] = i < pushed ? (uint)popcount(stack.rays[DAPPLE_STACK_BOTTOM + i]) : 0u;
  }
}

/* In: for each item two sets of rays for each of eight lanes. Out: 49 words an item: the first sets, added
   ray by ray; the lanes that hold ray `item`, and that hold any (0 or all bits); the first sets of the
   lanes in the bits of `item`; both sets after take_rays(); the rays that any lane holds. */
__kernel void sets_of_rays(__global const ulong* sets, __global ulong* found) {
  const uint item = get_global_id(0);
  const ulong8 rays = vload8(2u * item, sets);
  LaneSets some, taken = to_lane_sets(vload8(2u * item + 1u, sets));
  start_lane_sets(&some);
  for (uint i = 0; i < 64u; ++i) add_to_lane_sets(&some, i, convert_int8((rays & 1UL << i) != 0UL));
  LaneSets kept = some;
  keep_lanes(&kept, lanes_of_bits(item));
  __global ulong* to = found + 49u * item;
  vstore8(from_lane_sets(&some), 0, to);
  vstore8(as_ulong8(convert_long8(lanes_with_ray(&some, item % 64u))), 1, to);
  vstore8(as_ulong8(convert_long8(lanes_with_rays(&some))), 2, to);
  vstore8(from_lane_sets(&kept), 3, to);
  to[48] = rays_of_any_lane(&some);
  take_rays(&some, &taken);
  vstore8(from_lane_sets(&some), 4, to);
  vstore8(from_lane_sets(&taken), 5, to);
}
