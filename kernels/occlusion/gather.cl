/* Copies the rays of a few points of a queue, with what an occlusion pass found for them: the bias report
   traces these rays again. In: slots of the points in the active list. Out: rays and occlusions, in this
   order, from `first` on. */
#include "dapple/shared/ray.h"

__kernel void gather_rays(__global const uint* slots, uint ray_count, uint rays_per_point, uint first,
                          __global const Ray* rays, __global const Occlusion* occlusions,
                          __global Ray* gathered_rays, __global Occlusion* gathered_occlusions) {
  const uint i = (uint)get_global_id(0);
  if (i >= ray_count) return;
  const uint from = slots[i / rays_per_point] * rays_per_point + i % rays_per_point;
  gathered_rays[first + i] = rays[from];
  gathered_occlusions[first + i] = occlusions[from];
}
