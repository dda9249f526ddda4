/* What stops each ray of a queue. */
#include "nearest_ray.clh"
#include "pass_params.h"
#include "surface_point.clh"

/* Different rays have unrelated thresholds even where their keys are equal. */
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
  Layers layers; /* only the first ray's are used */
  start_layers((float16)(threshold_of(rays + item)), &layers);
  Nearest nearest = {no_hit(ray.t_max), &layers, 0u, 0u, 0u};
  do {
    nearest.hit = no_hit(ray.t_max);
    find_closest(scene, params.scene.root, params.scene.has_top != 0u, DAPPLE_WORLD, span,
                 &nearest);
  } while (pass_layers(&layers, (float16)(nearest.hit.t)).s0);
  __global SurfacePoint* point = points + item;
  point->visits = min(nearest.visits, 65535u) | min(nearest.tests, 65535u) << 16;
  const float t = nearest.hit.t;
  if (t < ray.t_max) {
    store_point(scene, nearest.hit, span.origin, span.direction,
                ray.first_area + ray.solid_angle * t * t, point);
  } else {
    point->t = -1.0f;
  }
}
