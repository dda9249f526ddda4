/* Lists the samples that hit a surface, in ascending order. In: hit bits. Out: the active list. One
   work-group computes a prefix sum: a slice is small, and atomics would change the order between runs. */
#include "vectors/lanes.clh"
#include "film/sample_hits.clh"

#define DAPPLE_SCAN_ITEMS 256

/* Sets the records' first_slot, and active_list[slot] = sample for every sample that hit;
   *active_count of them. */
__kernel __attribute__((reqd_work_group_size(DAPPLE_SCAN_ITEMS, 1, 1)))
void compact_hits(__global SampleHits* sample_hits, __global uint* active_list,
                  __global uint* active_count, uint count) {
  __local uint sums[DAPPLE_SCAN_ITEMS];
  const uint item = get_local_id(0);
  const uint share = (count + DAPPLE_SCAN_ITEMS - 1u) / DAPPLE_SCAN_ITEMS;
  const uint begin = min(item * share, count);
  const uint end = min(begin + share, count);
  uint hits = 0;
  for (uint i = begin; i < end; ++i) hits += popcount(sample_hits[i].hits);
  sums[item] = hits;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint step = 1; step < DAPPLE_SCAN_ITEMS; step *= 2) {
    const uint before = item >= step ? sums[item - step] : 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[item] += before;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  uint next = sums[item] - hits;
  for (uint i = begin; i < end; ++i) {
    sample_hits[i].first_slot = next;
    for (uint left = sample_hits[i].hits; left; left &= left - 1u) {
      active_list[next++] = i * DAPPLE_HIT_BITS + lowest_bit(left);
    }
  }
  if (item == DAPPLE_SCAN_ITEMS - 1u) *active_count = sums[item];
}
