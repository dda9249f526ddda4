/* Lists the samples that hit a surface, in ascending order. In: hit bits. Out: the active list. Work-groups
   compute prefix sums (Blelloch 1990) of their records; with several of them count_hits runs before. Atomics
   would change the order between runs. Where rays are in packets, on CPUs, one work-group does
   all, since a slice is small. */
#include "vectors/lanes.clh"
#include "film/sample_hits.clh"
#include "dapple/shared/pass_params.h"

/* Records [begin, end) of a work-group or of one of its items. */
typedef struct RecordRange {
  uint begin, end;
} RecordRange;

/* The consecutive records of this work-item; each work-group has `of_group` of them, `count` in all. */
inline RecordRange records_of_item(uint count, uint of_group) {
  const uint share = (of_group + DAPPLE_SCAN_ITEMS - 1u) / DAPPLE_SCAN_ITEMS;
  const uint last = min((uint)(get_group_id(0) + 1u) * of_group, count);
  RecordRange range;
  range.begin = min((uint)get_group_id(0) * of_group + (uint)get_local_id(0) * share, last);
  range.end = min(range.begin + share, last);
  return range;
}

inline uint count_range(__global const SampleHits* sample_hits, RecordRange range) {
  uint hits = 0u;
  for (uint i = range.begin; i < range.end; ++i) hits += popcount(sample_hits[i].hits);
  return hits;
}

/* Replaces sums[i] by the sum of sums[0] to sums[i]. */
inline void scan_sums(__local uint* sums) {
  const uint item = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint step = 1; step < DAPPLE_SCAN_ITEMS; step *= 2) {
    const uint before = item >= step ? sums[item - step] : 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[item] += before;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

/* group_sums[g] = the number of hits in the records of work-group g. */
__kernel __attribute__((reqd_work_group_size(DAPPLE_SCAN_ITEMS, 1, 1)))
void count_hits(__global const SampleHits* sample_hits, __global uint* group_sums, uint count, uint of_group) {
  __local uint sums[DAPPLE_SCAN_ITEMS];
  sums[get_local_id(0)] = count_range(sample_hits, records_of_item(count, of_group));
  scan_sums(sums);
  if (get_local_id(0) == DAPPLE_SCAN_ITEMS - 1u) group_sums[get_group_id(0)] = sums[DAPPLE_SCAN_ITEMS - 1u];
}

/* Number of hits in the work-groups before this one. */
inline uint hits_before_group(__global const uint* group_sums, __local uint* sums) {
  uint before = 0u;
  for (uint i = get_local_id(0); i < get_group_id(0); i += DAPPLE_SCAN_ITEMS) before += group_sums[i];
  sums[get_local_id(0)] = before;
  scan_sums(sums);
  const uint all = sums[DAPPLE_SCAN_ITEMS - 1u];
  barrier(CLK_LOCAL_MEM_FENCE);
  return all;
}

/* Sets the records' first_slot, and active_list[slot] = sample for every sample that hit;
   *active_count of them. */
__kernel __attribute__((reqd_work_group_size(DAPPLE_SCAN_ITEMS, 1, 1)))
void compact_hits(__global SampleHits* sample_hits, __global uint* active_list, __global uint* active_count,
                  __global const uint* group_sums, uint count, uint of_group) {
  __local uint sums[DAPPLE_SCAN_ITEMS];
  const uint item = get_local_id(0);
  const uint before = get_group_id(0) ? hits_before_group(group_sums, sums) : 0u;
  const RecordRange range = records_of_item(count, of_group);
  const uint hits = count_range(sample_hits, range);
  sums[item] = hits;
  scan_sums(sums);
  uint next = before + sums[item] - hits;
  for (uint i = range.begin; i < range.end; ++i) {
    sample_hits[i].first_slot = next;
    for (uint left = sample_hits[i].hits; left; left &= left - 1u) {
      active_list[next++] = i * DAPPLE_HIT_BITS + lowest_bit(left);
    }
  }
  if (item == DAPPLE_SCAN_ITEMS - 1u && get_group_id(0) == get_num_groups(0) - 1u)
    *active_count = before + sums[item];
}
