/* The resolve kernels: add camera samples, AO and lights to the film. In: the queues of a slice. Out: film
   sums, in the planes of film_planes.h, and squares, see film.clh. */
#include "film/film.clh"

/* A SurfacePoint in fixed point: position (3), depth, normal (3), one hit. Depth and hit replace the point's
   t and offset. */
inline long8 surface_sums(ResolveParams params, float8 scale, __global const SurfacePoint* point) {
  float8 values = vload8(0, point->position);
  values.s3 = 0.0f;
  DAPPLE_UNROLL for (uint axis = 0; axis < 3u; ++axis) {
    values.s3 += (point->position[axis] - params.eye[axis]) * params.axis[axis];
  }
  values.s7 = 1.0f;
  return fixed_points(values * scale);
}

inline long8 in_order_of_planes(long8 s) {
  return (long8)(s.s7, s.s4, s.s5, s.s6, s.s0, s.s1, s.s2, s.s3);
}

/* Each ray is charged the visits and tests of its whole work-item. */
__kernel void resolve_surface(__global const PixelWork* work, __global const SurfacePoint* points,
                              __global const SampleHits* sample_hits, __global long* film,
                              ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const float n = params.scale, p = params.position_scale;
  const float8 scale = (float8)(p, p, p, params.depth_scale, n, n, n, 1.0f);
  long8 of_points = (long8)(0);
  long visits = 0, tests = 0;
  const uint begin = local_pixel * params.slice.sample_count;
  const uint end = begin + params.slice.sample_count;
  for (uint r = begin / DAPPLE_HIT_BITS; r * DAPPLE_HIT_BITS < end; ++r) {
    const SampleHits record = sample_hits[r];
    const uint range = range_of_samples(r, begin, end);
    const uint rays = popcount(range) >> params.splitting_bits;
    visits += (long)record.visits * rays;
    tests += (long)record.tests * rays;
    for (uint left = record.hits & range; left; left &= left - 1u)
      of_points += surface_sums(params, scale, points + r * DAPPLE_HIT_BITS + lowest_bit(left));
  }
  const FilmPixel pixel = film_pixel(work, params, local_pixel);
  if (visits | tests) {
    add_to_plane(film, params, DAPPLE_PLANE_CAMERA_VISITS, pixel, visits);
    add_to_plane(film, params, DAPPLE_PLANE_CAMERA_TESTS, pixel, tests);
  }
  if (!of_points.s7) return;
  add_to_planes(film, params, DAPPLE_PLANE_CAMERA_VISITS, pixel, in_order_of_planes(of_points));
}

/* Squares: of occlusion, which is 0 where samples missed. A ray of weight 0 is hidden, any other has
   weight 1. */
__kernel void resolve_ao(__global const PixelWork* work, __global const SampleHits* sample_hits,
                         __global const Ray* rays, __global const Occlusion* occlusions,
                         __global const SampleAlbedo* albedos, __global long* film,
                         __global float* squares, ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  long8 sums = (long8)(0);
  long visits = 0, tests = 0;
  Batches batches = no_batches();
  const float inverse_rays = 1.0f / params.rays;
  uint ray = sample_slot(sample_hits, begin) * params.rays;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    float value = 0.0f;
    const bool hit = sample_hit(sample_hits, begin + s);
    const float3 albedo = sample_albedo(albedos, params, begin + s, hit);
    const uint end = ray + (hit ? params.rays : 0u);
    for (; ray < end; ++ray) {
      const Occlusion found = occlusions[ray];
      const float seen = found.transmittance * rays[ray].weight;
      value += (1.0f - seen) * inverse_rays;
      __global const float* direction = rays[ray].direction;
      const float8 factors =
          (float8)(1.0f, direction[0], direction[1], direction[2], albedo.x, albedo.y, albedo.z, 0.0f);
      sums += fixed_points(seen * params.scale * factors);
      visits += visits_of(found.visits);
      tests += tests_of(found.visits);
    }
    add_to_batch(&batches, s, value);
  }
  const FilmPixel pixel = film_pixel(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  add_to_planes(film, params, params.backs ? 1u : DAPPLE_AO_PLANES, pixel,
                (long8)(sums.s0123, visits, tests, 0, 0));
  add_costs_of_backs(film, params, pixel, visits, tests);
  if (params.albedo) add_color(film, params, DAPPLE_AO_PLANES, pixel, sums.s45674567);
}

/* Irradiances are those at radiance 1. */
__kernel void resolve_light(__global const PixelWork* work, __global const SampleHits* sample_hits,
                            __global const Ray* rays, __global const Occlusion* occlusions,
                            __global const SampleAlbedo* albedos, __global long* film,
                            __global float* squares, ResolveParams params) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  long8 sums = (long8)(0);
  Batches batches = no_batches();
  const float inverse_rays = 1.0f / params.rays;
  uint ray = sample_slot(sample_hits, begin) * params.rays;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    float value = 0.0f;
    const bool hit = sample_hit(sample_hits, begin + s);
    const float3 albedo = sample_albedo(albedos, params, begin + s, hit);
    const uint end = ray + (hit ? params.rays : 0u);
    for (; ray < end; ++ray) {
      const Occlusion found = occlusions[ray];
      const float weight = rays[ray].weight;
      value += weight * found.transmittance * inverse_rays;
      const float open = fmin(weight * params.scale, DAPPLE_MOST_VALUE), seen = open * found.transmittance;
      const float visits = visits_of(found.visits), tests = tests_of(found.visits);
      const float3 reflected = seen * albedo;
      sums += fixed_points(
          (float8)(seen, open, visits, tests, reflected.x, reflected.y, reflected.z, 0.0f));
      if (open > DAPPLE_SMALL_VALUE) sums = stop_at_most(sums);
    }
    add_to_batch(&batches, s, value);
  }
  const FilmPixel pixel = film_pixel(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  const uint planes = DAPPLE_LIGHT_PLANES + (params.albedo ? DAPPLE_REFLECTED_PLANES : 0u);
  add_to_planes(film, params, params.backs ? 1u : planes, pixel, sums);
  add_costs_of_backs(film, params, pixel, sums.s2, sums.s3);
}
