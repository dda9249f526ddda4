/* Adds up what the rays of each point found, DAPPLE_SUMMED_RAYS rays at a time, so that the host reads a sum for
   each point and not its rays. In: a queue of rays and their transmittances. Out: the sums of a point one after the
   other. */
#include "dapple/shared/ray.h"

__kernel void sum_rays(__global const Ray* rays, __global const Occlusion* occlusions, __global RaySums* sums,
                       uint point_count, uint rays_per_point) {
  const uint per_point = (rays_per_point + DAPPLE_SUMMED_RAYS - 1u) / DAPPLE_SUMMED_RAYS;
  const uint i = get_global_id(0), point = i / per_point;
  if (point >= point_count) return;
  const uint first = point * rays_per_point + i % per_point * DAPPLE_SUMMED_RAYS;
  const uint end = min(first + DAPPLE_SUMMED_RAYS, (point + 1u) * rays_per_point);
  RaySums sum = {0.0f, 0.0f, {0.0f, 0.0f, 0.0f}};
  for (uint r = first; r < end; ++r) {
    __global const Ray* ray = rays + r;
    if (!(ray->weight > 0.0f)) continue;
    const float seen = ray->weight * occlusions[r].transmittance;
    sum.weight += ray->weight;
    sum.seen += seen;
    for (uint axis = 0; axis < 3u; ++axis) sum.direction[axis] += seen * ray->direction[axis];
  }
  sums[i] = sum;
}
