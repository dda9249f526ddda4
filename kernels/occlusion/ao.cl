/* The AO pass: generates ambient occlusion rays, sixteen for each work-item. In: the surface points
   and the list of active ones. Out: the ray queue, at most DAPPLE_RAY_LANES rays for each item. */
#include "occlusion/ao_rays.clh"

/* Index of a ray in the queue = index of its active point * params.rays + ray of the point. */
__kernel void ao_rays(__global const SurfacePoint* points, __global const uint* active_list,
                      __global Ray* queue, AoParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  PointRays rays;
  load_points(points, active_list, first, end, params.rays, &rays);
  make_ao_rays(&rays, params, queue + first);
}
