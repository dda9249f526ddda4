/* The AO pass: cosine-weighted rays from every active point, sixteen rays an item. */
#include "direction.clh"
#include "pass_params.h"
#include "point_rays.clh"

/* Directions in the frame of the normal: x, y on the disk below them, z along it. */
typedef struct DiskPlaces {
  Floats16 x, y, z;
} DiskPlaces;

inline void choose_directions(const PointRays* rays, AoParams params, DiskPlaces* disk) {
  const Floats16 u = rays->u, v = rays->v;
  Floats16 x, y; /* in loops of scalars, so that compilers make vectors of them */
  if (params.whole_sets) {
    const Uints16 pixel = rays->pixel, index = rays->index;
    const float inverse_count = 1.0f / params.rays;
    for (uint i = 0; i < DAPPLE_RAY_LANES; ++i) {
      const uint turn = hash_pair(hash_pair(pixel.u[i], DAPPLE_PAIR_AO_TURN), params.seed);
      sunflower_disk(index.u[i], inverse_count, u.f[i], turn, x.f + i, y.f + i);
    }
  } else {
    for (uint i = 0; i < DAPPLE_RAY_LANES; ++i)
      concentric_disk(u.f[i], v.f[i], x.f + i, y.f + i);
  }
  disk->x = x;
  disk->y = y;
  disk->z.v = sqrt(max(1.0f - x.v * x.v - y.v * y.v, 1e-8f));
}

/* The pdf is cos / pi, so a ray's share of the hemisphere is pi / (n cos). */
inline void aim_rays(const PointRays* rays, AoParams params, const DiskPlaces* disk,
                     RayWays* ways) {
  const float16 x = disk->x.v, y = disk->y.v, z = disk->z.v;
  float16 tangent[3], bitangent[3], direction[3];
  make_frames(rays->normal[0].v, rays->normal[1].v, rays->normal[2].v, tangent, bitangent);
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis)
    direction[axis] = tangent[axis] * x + bitangent[axis] * y + rays->normal[axis].v * z;
  const float16 length = sqrt(dot_16(direction, direction));
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis)
    ways->direction[axis].v = direction[axis] / length;
  ways->t_max.v = (float16)(params.t_max);
  ways->solid_angle.v = min(M_PI_F * params.inverse_count / z, 2.0f * M_PI_F);
  ways->weight.v = (float16)(1.0f);
}

/* Ray = active point * rays + ray of the point. */
__kernel void ao_rays(__global const SurfacePoint* points, __global const uint* active_list,
                      __global Ray* queue, AoParams params) {
  const uint first = get_global_id(0) * DAPPLE_RAY_LANES;
  const uint end = params.point_count * params.rays;
  if (first >= end) return;
  PointRays rays;
  DiskPlaces disk;
  load_points(points, active_list, first, end, params.rays, &rays);
  choose_places(DAPPLE_PAIR_AO, params.seed, &rays);
  choose_directions(&rays, params, &disk);
  RayWays ways;
  aim_rays(&rays, params, &disk, &ways);
  store_rays(&rays, &ways, 0u, queue + first);
}
