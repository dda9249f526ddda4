/* The vectorized opacity model of footprint.clh. In: nodes and directions; out: optical depths of
   each node's children for a ray that crosses `chords` mean chords of each box. The ray's position
   in the box has no effect, because the nodes have no mass concentration. */
#include "opacity/footprint.clh"

__kernel void depths(__global const BvhNode* nodes, __global const float* directions,
                     __global float* results, float chords, uint count) {
  const uint item = get_global_id(0);
  if (item >= count) return;
  const float3 direction = vload3(item, directions);
  const ChildSizes sizes = child_sizes(nodes + item);
  const Facing facing = facing_areas(sizes, direction);
  BoxHits hits;
  hits.hit = (int8)(-1);
  hits.enter = (float8)(0.0f);
  hits.leave = chords * sizes.x * sizes.y * sizes.z / facing.sum;
  const Span span = make_span((float3)(0.0f), direction, INFINITY);
  vstore8(child_optical_depths(nodes + item, hits, sizes, facing, span), item, results);
}

/* Calls minus_log(), with eight values an item. */
__kernel void minus_logs(__global const float* values, __global float* results, uint count) {
  const uint item = get_global_id(0);
  if (item < count) vstore8(minus_log(vload8(item, values)), item, results);
}
