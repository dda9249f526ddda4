/* The AO pass: cosine-weighted rays from every active point. */
#include "direction.clh"
#include "pass_params.h"
#include "random.clh"
#include "scene.clh"

/* Item = active point * rays + ray. The pdf is cos / pi, so a ray's share of the
   hemisphere is pi / (n cos). */
__kernel void ao_rays(__global const SurfacePoint* points, __global const uint* active_list,
                      __global Ray* rays, AoParams params) {
  const uint item = get_global_id(0);
  if (item >= params.point_count * params.rays) return;
  const SurfacePoint point = points[active_list[item / params.rays]];
  const uint index = point.sample * params.rays + item % params.rays;
  const float2 u = sample_2d(point.pixel, index, DAPPLE_PAIR_AO, params.seed);
  const float2 disk = concentric_disk(u);
  const float cosine = sqrt(fmax(1e-8f, 1.0f - dot(disk, disk)));
  const float3 normal = (float3)(point.normal[0], point.normal[1], point.normal[2]);
  const float3 position = (float3)(point.position[0], point.position[1], point.position[2]);
  float3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  __global Ray* ray = rays + item;
  store3(ray->origin, position + normal * point.offset);
  store3(ray->direction, normalize(tangent * disk.x + bitangent * disk.y + normal * cosine));
  ray->t_max = params.t_max;
  ray->solid_angle = fmin(2.0f * M_PI_F, M_PI_F * params.inverse_count / cosine);
  ray->first_area = point.area;
  ray->light = 0;
  ray->weight = 1.0f;
  ray->key = ray_key(point.pixel, index, DAPPLE_PAIR_AO, params.seed);
}
