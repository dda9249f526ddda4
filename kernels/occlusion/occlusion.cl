/* The occlusion pass with single rays: each work-item traces one ray. In: the scene and the ray
   queue. Out: the transmittance and the costs of each ray, in queue order. The variant of the
   program (DAPPLE_PREFILTERED) decides between the exact and the prefiltered estimator. */
#include "occlusion/traverse.clh"

__kernel void occlusion(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                        __global const SegmentBlock* segments,
                        __global const TexturedTriangle* textured,
                        __global const MaterialRecord* materials, __global const uchar* texels,
                        __global const InstanceRecord* instances, __global const Ray* rays,
                        __global Occlusion* results, OcclusionParams params) {
  const uint item = get_global_id(0);
  if (item >= params.ray_count) return;
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  const Transmittance found = traverse(scene, params, rays[item]);
  results[item].transmittance = found.value;
  results[item].visits = pack_costs(found.visits, found.tests);
}
