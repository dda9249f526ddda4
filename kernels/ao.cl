/* The AO pass: cosine-weighted rays from every active point, sixteen rays an item. */
#include "direction.clh"
#include "pass_params.h"
#include "point_rays.clh"

/* Directions in the frame of the normal: x, y on the disk below them. */
typedef struct DiskPlaces {
  float x[DAPPLE_RAY_LANES], y[DAPPLE_RAY_LANES], cosine[DAPPLE_RAY_LANES];
} DiskPlaces;

/* Loops of scalars, so that compilers make vectors of them. */
inline void choose_directions(const PointRays* rays, AoParams params, DiskPlaces* disk) {
  if (params.whole_sets) {
    const float inverse_count = 1.0f / params.rays;
    for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) {
      const uint turn = hash_pair(hash_pair(rays->pixel[i], DAPPLE_PAIR_AO_TURN), params.seed);
      sunflower_disk(rays->index[i], inverse_count, rays->u[i], turn, disk->x + i, disk->y + i);
    }
  } else {
    for (uint i = 0; i < DAPPLE_RAY_LANES; ++i)
      concentric_disk(rays->u[i], rays->v[i], disk->x + i, disk->y + i);
  }
  for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) {
    disk->cosine[i] = sqrt(fmax(1e-8f, 1.0f - disk->x[i] * disk->x[i] - disk->y[i] * disk->y[i]));
  }
}

/* The pdf is cos / pi, so a ray's share of the hemisphere is pi / (n cos). */
inline void store_ray(__global const SurfacePoint* point, AoParams params, const DiskPlaces* disk,
                      uint i, uint key, __global Ray* ray) {
  const float3 normal = load3(point->normal);
  float3 tangent, bitangent;
  make_frame(normal, &tangent, &bitangent);
  store3(ray->origin, load3(point->position) + normal * point->offset);
  store3(ray->direction, normalize(tangent * disk->x[i] + bitangent * disk->y[i] +
                                   normal * disk->cosine[i]));
  ray->t_max = params.t_max;
  ray->solid_angle = fmin(2.0f * M_PI_F, M_PI_F * params.inverse_count / disk->cosine[i]);
  ray->first_area = point->area;
  ray->light = 0;
  ray->weight = 1.0f;
  ray->key = key;
}

/* Ray = active point * rays + ray of the point. */
__kernel void ao_rays(__global const SurfacePoint* points, __global const uint* active_list,
                      __global Ray* queue, AoParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  PointRays rays;
  DiskPlaces disk;
  choose_rays(points, active_list, first, end, params.rays, DAPPLE_PAIR_AO, params.seed, &rays);
  choose_directions(&rays, params, &disk);
  for (uint i = 0; i < rays.count; ++i) {
    store_ray(points + rays.point[i], params, &disk, i, rays.key[i], queue + first + i);
  }
}
