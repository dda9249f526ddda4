/* Finds the surface that stops each ray of a queue. In: the scene and rays. Out: hits, with position and
   normal. */
#include "camera/closest_ray.clh"
#include "dapple/shared/pass_params.h"
#include "camera/surface_point.clh"

/* Origin and direction count too, so that rays with equal keys have unrelated thresholds. */
inline float threshold_of(__global const Ray* ray) {
  uint bits = ray->key;
  for (uint axis = 0; axis < 3u; ++axis) {
    bits = hash_pair(as_uint(ray->origin[axis]), bits);
    bits = hash_pair(as_uint(ray->direction[axis]), bits);
  }
  return unit_float(bits);
}

__kernel void closest_hit(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const SegmentBlock* segments,
                          __global const TexturedTriangle* textured,
                          __global const MaterialRecord* materials, __global const uchar* texels,
                          __global const InstanceRecord* instances, __global const Ray* rays,
                          __global SurfacePoint* points, OcclusionParams params) {
  const uint item = get_global_id(0);
  if (item >= params.ray_count) return;
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  const Ray ray = rays[item];
  const Span span = make_span(load3(rays[item].origin), load3(rays[item].direction), ray.t_max);
  ClosestHits16 closest; /* only the first ray's is used */
  SingleRay single;
  const TexelArea covers = {0.0f, 0.0f};
  start_k_buffer((float16)(threshold_of(rays + item)), &closest.k_buffer);
  closest.visits = closest.tests = 0u;
  do {
    closest.t.v = (float16)(ray.t_max);
    closest.primitive.v = closest.instance.v = (int16)(-1);
    start_single(span, covers, 0u, DAPPLE_WORLD, params.scene.has_top != 0u, &single);
    prefetch_entry(scene, params.scene.root, 0.0f, &single);
    while (go_down(scene, &single, &closest)) {
    }
  } while (advance_k_buffer(&closest.k_buffer).s0);
  __global SurfacePoint* point = points + item;
  point->visits = pack_costs(closest.visits, closest.tests);
  const float t = closest.t.f[0];
  if (t < ray.t_max) {
    store_point(scene, hit_of_ray(&closest, 0u), span.origin, span.direction,
                ray.first_area + ray.solid_angle * t * t, point);
  } else {
    point->t = -1.0f;
  }
}
