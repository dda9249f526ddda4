/* The camera pass for GPUs: each work-item intersects one camera ray with the scene. In and out: as
   camera/camera.cl. A work-group has the rays of one of its items. */
#include "camera/surface_point.clh"
#include "scalar/closest_search.clh"

/* The most records of SampleHits that a work-group fills. */
#define DAPPLE_GROUP_RECORDS (DAPPLE_ITEM_RAYS * DAPPLE_MAX_CAMERA_SPLITTING / DAPPLE_HIT_BITS)

/* Stores where sample `d` of the ray stops. Members as store_stochastic_hit() has them. */
DAPPLE_INLINE void store_stop(Scene scene, CameraParams params, const CameraSample* chosen, const CameraRay* ray,
                              uint d, SurfaceHit hit, __global SurfacePoint* point) {
  const WorldPoint at = is_medium_hit(hit.instance)
                            ? point_in_medium(scene, hit, ray->origin, ray->direction, ray->key)
                            : point_of_hit(scene, hit, ray->origin, ray->direction);
  const float length_of = length(at.normal);
  const float3 normal = at.normal / (dot(at.normal, ray->direction) > 0.0f ? -length_of : length_of);
  store3(point->position, at.position);
  store3(point->normal, normal);
  point->t = params.keep_hits ? as_float(hit.instance) : hit.t;
  point->offset = at.offset;
  point->area = params.inverse_spp * (ray->pixel_first + ray->pixel_angle * hit.t * hit.t);
  point->pixel = chosen->pixel;
  point->sample = chosen->sample + d;
  point->visits = params.keep_hits ? hit.primitive : 0u;
}

/* Traces ray `number` of the slice; sets the bits of its samples that hit in `hit_bits`, which begin with those of
   the group's first sample. */
DAPPLE_INLINE SearchCosts trace_ray(Scene scene, CameraParams params, uint number, __global const PixelWork* work,
                                    __global SurfacePoint* points, __local uint* hit_bits) {
  const SearchCosts none = {0u, 0u};
  const CameraSample chosen = choose_sample(work, params, number);
  if (!may_see(params, &chosen)) return none;
  const CameraRay ray = aim_ray(params, &chosen);
  StochasticHitsScalar stops;
  stops.count = 1u << params.splitting_bits;
  for (uint d = 0; d < stops.count; ++d) {
    stops.threshold[d] = threshold_of_sample(params, &chosen, d);
    stops.hit[d].t = INFINITY;
    stops.hit[d].primitive = stops.hit[d].instance = 0u;
  }
  const SearchCosts costs = search_closest(scene, params, &ray, &stops);
  for (uint d = 0; d < stops.count && stops.hit[d].t < INFINITY; ++d) {
    const uint sample = (number << params.splitting_bits) + d;
    const uint in_group = sample - ((number / DAPPLE_ITEM_RAYS * DAPPLE_ITEM_RAYS) << params.splitting_bits);
    store_stop(scene, params, &chosen, &ray, d, stops.hit[d], points + sample);
    atomic_or(hit_bits + in_group / DAPPLE_HIT_BITS, 1u << in_group % DAPPLE_HIT_BITS);
  }
  return costs;
}

__kernel __attribute__((reqd_work_group_size(DAPPLE_ITEM_RAYS, 1, 1)))
void camera_hits_scalar(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                        __global const SegmentBlock* segments, __global const TexturedTriangle* textured,
                        __global const MaterialRecord* materials, __global const uchar* texels,
                        __global const InstanceRecord* instances, __global const PixelWork* work,
                        __global SurfacePoint* points, __global SampleHits* sample_hits, CameraParams params) {
  __local uint hit_bits[DAPPLE_GROUP_RECORDS], visits, tests;
  const uint ray = get_global_id(0), in_group = get_local_id(0);
  if (in_group < DAPPLE_GROUP_RECORDS) hit_bits[in_group] = 0u;
  if (in_group == 0u) visits = tests = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint rays = params.slice.pixel_count * (params.slice.sample_count >> params.splitting_bits);
  if (ray < rays) {
    const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
    const SearchCosts costs = trace_ray(scene, params, ray, work, points, hit_bits);
    atomic_add(&visits, costs.visits);
    atomic_add(&tests, costs.tests);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint first_sample = (ray - in_group) << params.splitting_bits, samples = rays << params.splitting_bits;
  const uint record = first_sample / DAPPLE_HIT_BITS + in_group;
  if (in_group < (DAPPLE_ITEM_RAYS << params.splitting_bits) / DAPPLE_HIT_BITS && record * DAPPLE_HIT_BITS < samples) {
    const SampleHits of_samples = {hit_bits[in_group], 0u, visits, tests};
    sample_hits[record] = of_samples;
  }
}
