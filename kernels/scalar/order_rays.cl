/* Orders the rays of a queue so that those of neighbouring work-items are alike: GPUs run the items of a vector in
   step, and rays of one direction visit the same nodes. Each work-group sorts a batch of consecutive rays, which
   start near each other, by direction (a counting sort, Knuth 5.2). In: the queue. Out: a permutation of each
   batch; the order of rays in one cell varies, but no result depends on it. */
#include "dapple/shared/corner_normals.h"
#include "dapple/shared/pass_params.h"

#define DAPPLE_ORDER_SIDE 8u  /* cells along a side of the octahedral square */
#define DAPPLE_ORDER_CELLS (DAPPLE_ORDER_SIDE * DAPPLE_ORDER_SIDE + 1u)

/* The cell of a ray's direction; the last one is for hidden rays. */
DAPPLE_INLINE uint cell_of(__global const Ray* ray) {
  if (ray->t_max < 0.0f) return DAPPLE_ORDER_CELLS - 1u;
  const float direction[3] = {ray->direction[0], ray->direction[1], ray->direction[2]};
  float x, y;
  octahedral_point(direction, &x, &y);
  const uint column = min((uint)((x + 1.0f) * (0.5f * DAPPLE_ORDER_SIDE)), DAPPLE_ORDER_SIDE - 1u);
  const uint row = min((uint)((y + 1.0f) * (0.5f * DAPPLE_ORDER_SIDE)), DAPPLE_ORDER_SIDE - 1u);
  return row * DAPPLE_ORDER_SIDE + (row & 1u ? DAPPLE_ORDER_SIDE - 1u - column : column);
}

/* Replaces the number of rays in each cell by the number in the cells before it. */
DAPPLE_INLINE void count_before(__local uint* cells) {
  uint before = 0u;
  for (uint cell = 0; cell < DAPPLE_ORDER_CELLS; ++cell) {
    const uint of_cell = cells[cell];
    cells[cell] = before;
    before += of_cell;
  }
}

__kernel __attribute__((reqd_work_group_size(DAPPLE_ORDER_GROUP, 1, 1)))
void order_rays(__global const Ray* rays, __global uint* order, uint ray_count) {
  __local uint next[DAPPLE_ORDER_CELLS];
  __local ushort cells[DAPPLE_ORDER_BATCH];
  const uint item = get_local_id(0), first = get_group_id(0) * DAPPLE_ORDER_BATCH;
  const uint count = min(ray_count - first, DAPPLE_ORDER_BATCH);
  for (uint cell = item; cell < DAPPLE_ORDER_CELLS; cell += DAPPLE_ORDER_GROUP) next[cell] = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = item; i < count; i += DAPPLE_ORDER_GROUP) {
    cells[i] = (ushort)cell_of(rays + first + i);
    atomic_inc(next + cells[i]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0u) count_before(next);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint i = item; i < count; i += DAPPLE_ORDER_GROUP) order[first + atomic_inc(next + cells[i])] = first + i;
}
