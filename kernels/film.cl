/* The passes that add up camera samples, AO and lights: see film.clh. */
#include "film.clh"
#include "lanes.clh"
#include "scene.clh"

/* Hits, normal (3), position (3), depth: the order of their planes. */
inline long8 surface_sums(ResolveParams params, __global const SurfacePoint* point) {
  float along = 0.0f;
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    along += (point->position[axis] - params.eye[axis]) * params.axis[axis];
  }
  const float n = params.scale, p = params.position_scale;
  const float8 values = (float8)(1.0f, point->normal[0], point->normal[1], point->normal[2],
                                 point->position[0], point->position[1], point->position[2], along);
  return fixed_points(values * (float8)(1.0f, n, n, n, p, p, p, params.depth_scale));
}

/* Planes: hits, N (3), P (3), Z, camera visits, camera tests. Of nodes and triangles each ray is
   given those of its whole item. */
__kernel void resolve_surface(__global const PixelWork* work, __global const SurfacePoint* points,
                              __global const SampleHits* sample_hits, __global long* film,
                              ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  PlaneSums sums;
  sums.v = (long8)(0);
  long visits = 0, tests = 0;
  const uint begin = local_pixel * params.slice.sample_count;
  const uint end = begin + params.slice.sample_count;
  for (uint r = begin / DAPPLE_HIT_BITS; r * DAPPLE_HIT_BITS < end; ++r) {
    const SampleHits record = sample_hits[r];
    const uint range = range_of_samples(r, begin, end);
    const uint rays = popcount(range) >> params.depth_bits;
    visits += (long)record.visits * rays;
    tests += (long)record.tests * rays;
    for (uint left = record.hits & range; left; left &= left - 1u) {
      sums.v += surface_sums(params, points + r * DAPPLE_HIT_BITS + lowest_bit(left));
    }
  }
  const uint pixel = pixel_of(work, params, local_pixel);
  if (visits | tests) {
    add_to_plane(film, params, 8, pixel, visits);
    add_to_plane(film, params, 9, pixel, tests);
  }
  if (!sums.plane[0]) return;
  add_to_planes(film, params, 8u, pixel, &sums);
}

/* Planes: transmittance over hits, bent normal (3), visits, tests. Squares: of occlusion, which
   is 0 where samples missed. */
__kernel void resolve_ao(__global const PixelWork* work, __global const SampleHits* sample_hits,
                         __global const Ray* rays,
                         __global const Occlusion* occlusions, __global long* film,
                         __global float* squares, ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  PlaneSums sums;
  sums.v = (long8)(0);
  long visits = 0, tests = 0;
  Batches batches = no_batches();
  const float inverse_rays = 1.0f / params.rays;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    const bool hit = sample_hit(sample_hits, begin + s);
    const uint first = hit ? sample_slot(sample_hits, begin + s) * params.rays : 0u;
    float value = 0.0f;
    for (uint r = 0; hit && r < params.rays; ++r) {
      const uint item = first + r;
      const Occlusion found = occlusions[item];
      value += (1.0f - found.transmittance) * inverse_rays;
      __global const float* direction = rays[item].direction;
      const float seen = found.transmittance;
      sums.v += fixed_points((float8)(seen, seen * direction[0], seen * direction[1],
                                      seen * direction[2], 0.0f, 0.0f, 0.0f, 0.0f) *
                             params.scale);
      visits += found.visits & 65535u;
      tests += found.visits >> 16;
    }
    add_to_batch(&batches, s, value);
  }
  const uint pixel = pixel_of(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  add_to_planes(film, params, 4u, pixel, &sums);
  add_to_plane(film, params, 4, pixel, visits);
  add_to_plane(film, params, 5, pixel, tests);
}

/* Planes: irradiance at radiance 1, the same unoccluded, visits, tests. */
__kernel void resolve_light(__global const PixelWork* work, __global const SampleHits* sample_hits,
                            __global const Ray* rays,
                            __global const Occlusion* occlusions, __global long* film,
                            __global float* squares, ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  PlaneSums sums;
  sums.v = (long8)(0);
  long visits = 0, tests = 0;
  Batches batches = no_batches();
  const float inverse_rays = 1.0f / params.rays;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    const bool hit = sample_hit(sample_hits, begin + s);
    const uint first = hit ? sample_slot(sample_hits, begin + s) * params.rays : 0u;
    float value = 0.0f;
    for (uint r = 0; hit && r < params.rays; ++r) {
      const uint item = first + r;
      const Occlusion found = occlusions[item];
      const float weight = rays[item].weight;
      value += weight * found.transmittance * inverse_rays;
      sums.v += fixed_points((float8)(weight * found.transmittance, weight, 0.0f, 0.0f, 0.0f, 0.0f,
                                      0.0f, 0.0f) *
                             params.scale);
      visits += found.visits & 65535u;
      tests += found.visits >> 16;
    }
    add_to_batch(&batches, s, value);
  }
  const uint pixel = pixel_of(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  add_to_planes(film, params, 2u, pixel, &sums);
  add_to_plane(film, params, 2, pixel, visits);
  add_to_plane(film, params, 3, pixel, tests);
}
