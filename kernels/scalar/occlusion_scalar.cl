/* The occlusion pass with single rays for GPUs: each work-item traces one ray, one box and one primitive at a
   time, in the order that order_rays.cl made, if there is one. In and out: as occlusion/occlusion.cl. */
#include "scalar/transmittance.clh"

__kernel void occlusion_scalar(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                               __global const SegmentBlock* segments,
                               __global const TexturedTriangle* textured,
                               __global const MaterialRecord* materials, __global const uchar* texels,
                               __global const InstanceRecord* instances, __global const Ray* rays,
                               __global const uint* order, __global Occlusion* results, OcclusionParams params) {
  if (get_global_id(0) >= params.ray_count) return;
  const uint ray = order ? order[get_global_id(0)] : (uint)get_global_id(0);
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  const Transmittance found = traverse_scalar(scene, params, rays[ray]);
  results[ray].transmittance = found.value;
  results[ray].visits = pack_costs(found.visits, found.tests);
}
