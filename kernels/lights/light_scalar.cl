/* The light pass for GPUs: each work-item makes one shadow ray. In and out: as lights/light.cl. */
#include "lights/light_sample.clh"

/* ends_of_rays() for one ray. */
DAPPLE_INLINE float end_of_ray(const PointRay* ray, float distance) {
  const float largest = fmax(fabs(ray->origin.x), fmax(fabs(ray->origin.y), fabs(ray->origin.z)));
  return fmax(distance * (1.0f - DAPPLE_LIGHT_GAP) - largest * DAPPLE_LIGHT_ROUNDINGS, 0.0f);
}

/* aim_light_rays() for one ray. */
DAPPLE_INLINE RayDirection aim_light_ray(const PointRay* ray, LightSample sample, float radiance, float inverse_count) {
  RayDirection aimed;
  aimed.direction = sample.direction;
  aimed.weight = sample.solid_angle * fmax(dot(ray->normal, sample.direction), 0.0f) * radiance;
  aimed.t_max = aimed.weight > 0.0f ? end_of_ray(ray, sample.distance) : -1.0f;
  aimed.solid_angle = fmin(sample.solid_angle * inverse_count, 2.0f * M_PI_F);
  return aimed;
}

__kernel void light_rays_scalar(__global const SurfacePoint* points, __global const uint* active_list,
                                __global const LightRecord* lights, __global const EmitterTriangle* emitters,
                                __global const float* environments, __global Ray* queue, LightParams params) {
  const uint item = get_global_id(0);
  if (item >= params.point_count * params.rays) return;
  __global const LightRecord* light = lights + params.light;
  const PointRay ray = load_point_ray(points, active_list, item, params.rays, DAPPLE_PAIR_LIGHT + light->sequence,
                                      params.seed);
  float radiance;
  const LightSample sample = choose_light_sample(light, emitters, environments, &ray, &radiance);
  RayDirection aimed = aim_light_ray(&ray, sample, radiance, params.inverse_count);
  limit_near_view_ray_scalar(&ray, params.viewpoint, &aimed);
  if (params.shaded) hide_below_scalar(&ray, &aimed);
  store_ray(&ray, &aimed, light->id, queue + item);
}
