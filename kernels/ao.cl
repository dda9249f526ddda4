/* The AO pass: cosine-weighted rays from every active point, sixteen rays an item. */
#include "direction.clh"
#include "pass_params.h"
#include "random.clh"
#include "scene.clh"

#define DAPPLE_AO_LANES 16u /* kAoLanes in host/wavefront/passes.cpp */

/* Side by side: of each ray the point and the place in its pixel's sequence, and its direction
   in the frame of the normal: x, y on the disk below it. */
typedef struct AoRays {
  uint point[DAPPLE_AO_LANES], pixel[DAPPLE_AO_LANES], index[DAPPLE_AO_LANES];
  float x[DAPPLE_AO_LANES], y[DAPPLE_AO_LANES], cosine[DAPPLE_AO_LANES];
  uint key[DAPPLE_AO_LANES];
} AoRays;

/* Loops of scalars, so that compilers make vectors of them. */
inline void choose_directions(AoParams params, AoRays* rays) {
  for (uint i = 0; i < DAPPLE_AO_LANES; ++i) {
    float u, v;
    sample_square(rays->pixel[i], rays->index[i], DAPPLE_PAIR_AO, params.seed, &u, &v);
    concentric_disk(u, v, rays->x + i, rays->y + i);
    rays->cosine[i] = sqrt(fmax(1e-8f, 1.0f - rays->x[i] * rays->x[i] - rays->y[i] * rays->y[i]));
    rays->key[i] = ray_key(rays->pixel[i], rays->index[i], DAPPLE_PAIR_AO, params.seed);
  }
}

/* The pdf is cos / pi, so a ray's share of the hemisphere is pi / (n cos). */
inline void store_ray(__global const SurfacePoint* point, AoParams params, const AoRays* rays,
                      uint i, __global Ray* ray) {
  const float3 normal = load3(point->normal);
  float3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  store3(ray->origin, load3(point->position) + normal * point->offset);
  store3(ray->direction, normalize(tangent * rays->x[i] + bitangent * rays->y[i] +
                                   normal * rays->cosine[i]));
  ray->t_max = params.t_max;
  ray->solid_angle = fmin(2.0f * M_PI_F, M_PI_F * params.inverse_count / rays->cosine[i]);
  ray->first_area = point->area;
  ray->light = 0;
  ray->weight = 1.0f;
  ray->key = rays->key[i];
}

/* Ray = active point * rays + ray of the point. */
__kernel void ao_rays(__global const SurfacePoint* points, __global const uint* active_list,
                      __global Ray* queue, AoParams params) {
  const uint first = get_global_id(0) * DAPPLE_AO_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  const uint count = min(end - first, DAPPLE_AO_LANES);
  AoRays rays;
  uint active = first / params.rays, ray = first % params.rays;
  for (uint i = 0; i < DAPPLE_AO_LANES; ++i) {
    rays.point[i] = active_list[active];
    __global const SurfacePoint* point = points + rays.point[i];
    rays.pixel[i] = point->pixel;
    rays.index[i] = point->sample * params.rays + ray;
    if (i + 1u < count && ++ray == params.rays) {
      ray = 0;
      ++active;
    }
  }
  choose_directions(params, &rays);
  for (uint i = 0; i < count; ++i) {
    store_ray(points + rays.point[i], params, &rays, i, queue + first + i);
  }
}
