/* lanes.clh for patterns of sixteen bits, one an item: what each of its functions makes of them.
   Included once for each way in which it can be compiled. */
#include "lanes.clh"

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
  to[4] = bits_of_16((int16)(lanes_of_bits(pattern & 255u), lanes_of_bits(pattern >> 8)));
  to[5] = pattern ? lowest_bit(pattern) : lowest;
}
