/* Adds the light of a dome to the film, in red, green and blue. In: a slice's rays to the dome and their
   transmittances. Out: sums of the film, as resolve_light in film/film.cl makes them of other lights. */
#include "lights/dome.clh"
#include "film/film.clh"
#include "vectors/vectors.clh"

/* Texels that the rays [first, end) come from, sixteen of them at most. */
inline void find_texels(const Dome* dome, __global const Ray* rays, uint first, uint end,
                        Uints16* texels) {
  Fours16 records;
  for (uint i = 0; i < 16u; ++i)
    records.four[DAPPLE_TRANSPOSED_INDEX(i)] =
        vload4(1, (__global const float*)(rays + min(first + i, end - 1u)));
  float16 direction[4];
  transpose_fours(records.v, direction);
  Floats16 x, y, z;
  x.v = direction[0];
  y.v = direction[1];
  z.v = direction[2];
  for (uint i = 0; i < 16u; ++i) texels->u[i] = texel_towards(dome, x.f[i], y.f[i], z.f[i]);
}

/* Contribution of one ray: irradiance with and without occlusion, visits, tests. */
inline long8 dome_sums(float3 seen, float3 light, Occlusion found) {
  const float visits = visits_of(found.visits), tests = tests_of(found.visits);
  return fixed_points((float8)(seen.x, seen.y, seen.z, light.x, light.y, light.z, visits, tests));
}

/* Planes: irradiance (3) at radiance 1, the same unoccluded (3), visits, tests, irradiance times albedo (3).
   Squares: of its luminance. */
__kernel void resolve_dome(__global const PixelWork* work, __global const SampleHits* sample_hits,
                           __global const Ray* rays, __global const Occlusion* occlusions,
                           __global const SampleAlbedo* albedos, __global const LightRecord* lights,
                           __global const float* environments, __global long* film,
                           __global float* squares, ResolveParams params, uint light) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  const Dome dome = dome_of(lights + light, environments);
  const float inverse_rays = 1.0f / params.rays;
  long8 sums = (long8)(0), reflected = (long8)(0);
  Batches batches = no_batches();
  Uints16 texels;
  const uint first = sample_slot(sample_hits, begin) * params.rays;
  const uint last_sample = begin + params.slice.sample_count - 1u;
  const uint last_slot = sample_slot(sample_hits, last_sample);
  const uint last = (last_slot + sample_hit(sample_hits, last_sample)) * params.rays;
  uint ray = first;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    float value = 0.0f;
    const bool hit = sample_hit(sample_hits, begin + s);
    const float3 albedo = sample_albedo(albedos, params, begin + s, hit);
    const uint end = ray + (hit ? params.rays : 0u);
    for (; ray < end; ++ray) {
      const uint lane = (ray - first) % 16u;
      if (lane == 0u) find_texels(&dome, rays, ray, last, &texels);
      const float weight = rays[ray].weight;
      const float3 unoccluded = fmin(weight * texel_colour(&dome, texels.u[lane]) * params.scale, DAPPLE_MOST_VALUE);
      const Occlusion found = occlusions[ray];
      const float3 seen = unoccluded * found.transmittance, of_ray = seen * albedo;
      sums += dome_sums(seen, unoccluded, found);
      if (params.albedo)
        reflected += fixed_points((float8)(of_ray.x, of_ray.y, of_ray.z, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f));
      if (weight * params.scale > DAPPLE_SMALL_VALUE) {
        sums = stop_at_most(sums);
        reflected = stop_at_most(reflected);
      }
      value += weight * found.transmittance * inverse_rays;
    }
    add_to_batch(&batches, s, value);
  }
  const FilmPixel pixel = film_pixel(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  add_to_planes(film, params, params.backs ? DAPPLE_DOME_CHANNELS : DAPPLE_DOME_PLANES, pixel, sums);
  add_costs_of_backs(film, params, pixel, sums.s6, sums.s7);
  if (params.albedo) add_color(film, params, DAPPLE_DOME_PLANES, pixel, reflected);
}
