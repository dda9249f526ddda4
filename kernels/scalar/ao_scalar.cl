/* The AO pass for GPUs: each work-item generates one ray. In and out: as occlusion/ao.cl; occlusion/ao_rays.clh says
   how directions are distributed. */
#include "sampling/direction.clh"
#include "scalar/point_ray.clh"

/* choose_directions() and aim_ao_rays() for one ray. */
DAPPLE_INLINE RayDirection aim_ao_ray(const PointRay* ray, AoParams params) {
  float x, y;
  if (params.whole_sets) {
    const uint rotation = hash_pair(hash_pair(ray->pixel, DAPPLE_PAIR_AO_ROTATION), params.seed);
    vogel_disk(ray->index, 1.0f / params.rays, ray->u, rotation, &x, &y);
  } else {
    concentric_disk(ray->u, ray->v, &x, &y);
  }
  const float z = sqrt(fmax(1.0f - x * x - y * y, 1e-8f));
  float3 tangent, bitangent;
  make_frame(ray->normal, &tangent, &bitangent);
  const float3 direction = tangent * x + bitangent * y + ray->normal * z;
  const float cosine = fmax(z, params.whole_sets ? 0.5f : 0.0f);
  RayDirection aimed;
  aimed.direction = direction / length(direction);
  aimed.t_max = params.t_max;
  aimed.solid_angle = fmin(M_PI_F * params.inverse_count / cosine, 2.0f * M_PI_F);
  aimed.weight = 1.0f;
  return aimed;
}

__kernel void ao_rays_scalar(__global const SurfacePoint* points, __global const uint* active_list,
                             __global Ray* queue, AoParams params) {
  const uint item = get_global_id(0);
  if (item >= params.point_count * params.rays) return;
  const PointRay ray = load_point_ray(points, active_list, item, params.rays, DAPPLE_PAIR_AO, params.seed);
  RayDirection aimed = aim_ao_ray(&ray, params);
  limit_near_view_ray_scalar(&ray, params.viewpoint, &aimed);
  if (params.shaded) hide_below_scalar(&ray, &aimed);
  store_ray(&ray, &aimed, 0u, queue + item);
}
