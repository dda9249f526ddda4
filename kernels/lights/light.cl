/* The light pass: makes shadow rays from every active point to one light. In: surface points, a light. Out:
   rays to points that lights/light_samples.clh chose on it. The mean of weight times transmittance is the
   irradiance for a radiance of 1. */
#include "dapple/shared/light_record.h"
#include "dapple/shared/pass_params.h"
#include "lights/light_samples.clh"
#include "occlusion/point_rays.clh"

/* Where a ray to a point at `distance` ends. */
inline float16 ends_of_rays(const PointRays* rays, float16 distance) {
  const float16 largest = fmax(fabs(rays->origin[0].v), fmax(fabs(rays->origin[1].v), fabs(rays->origin[2].v)));
  return at_least_0(distance * (1.0f - DAPPLE_LIGHT_GAP) - largest * DAPPLE_LIGHT_ROUNDINGS);
}

/* A ray without a contribution gets t_max < 0 and is not traced. */
inline void aim_light_rays(const PointRays* rays, const LightSamples* samples, float inverse_count,
                           RayDirections* directions) {
  float16 cosine = (float16)(0.0f);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    directions->direction[axis].v = samples->direction[axis].v;
    cosine += rays->normal[axis].v * samples->direction[axis].v;
  }
  const float16 solid_angle = samples->solid_angle.v;
  directions->weight.v = solid_angle * at_least_0(cosine) * samples->radiance.v;
  directions->t_max.v = directions->weight.v > 0.0f ? ends_of_rays(rays, samples->distance.v) : (float16)(-1.0f);
  directions->solid_angle.v = min(solid_angle * inverse_count, 2.0f * M_PI_F);
}

__kernel void light_rays(__global const SurfacePoint* points, __global const uint* active_list,
                         __global const LightRecord* lights,
                         __global const EmitterTriangle* emitters,
                         __global const float* environments, __global Ray* queue,
                         LightParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  __global const LightRecord* light = lights + params.light;
  PointRays rays;
  LightSamples samples;
  RayDirections directions;
  load_points(points, active_list, first, end, params.rays, &rays);
  sample_unit_squares(DAPPLE_PAIR_LIGHT + light->sequence, params.seed, &rays);
  sample_light(light, emitters, environments, &rays, &samples);
  aim_light_rays(&rays, &samples, params.inverse_count, &directions);
  limit_near_view_ray(&rays, params.viewpoint, &directions);
  if (params.shaded) hide_below(&rays, &directions);
  store_rays(&rays, &directions, light->id, queue + first);
}
