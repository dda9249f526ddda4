/* Resolves the rays to a dome light. As resolve_light in film.cl, but in three channels. */
#include "lights/dome.clh"
#include "film/film.clh"

/* Contribution of one ray: irradiance with and without occlusion, visits, tests. */
inline long8 dome_sums(const Dome* dome, __global const Ray* ray, Occlusion found, float scale) {
  const float3 light = ray->weight * dome_colour(dome, load3(ray->direction)) * scale;
  const float3 seen = light * found.transmittance;
  return fixed_points((float8)(seen.x, seen.y, seen.z, light.x, light.y, light.z,
                               nodes_of(found), tests_of(found)));
}

/* Planes: irradiance (3) at radiance 1, the same unoccluded (3), visits, tests. Squares: of its
   luminance. */
__kernel void resolve_dome(__global const PixelWork* work, __global const SampleHits* sample_hits,
                           __global const Ray* rays, __global const Occlusion* occlusions,
                           __global const LightRecord* lights, __global const float* environments,
                           __global long* film, __global float* squares, ResolveParams params,
                           uint light) {
  const uint local_pixel = get_global_id(0);
  if (local_pixel >= params.slice.pixel_count) return;
  const uint begin = local_pixel * params.slice.sample_count;
  if (!any_sample_hit(sample_hits, begin, begin + params.slice.sample_count)) return;
  const Dome dome = dome_of(lights + light, environments);
  long8 sums = (long8)(0);
  Batches batches = no_batches();
  uint ray = sample_slot(sample_hits, begin) * params.rays;
  for (uint s = 0; s < params.slice.sample_count; ++s) {
    float value = 0.0f;
    const uint end = ray + (sample_hit(sample_hits, begin + s) ? params.rays : 0u);
    for (; ray < end; ++ray) {
      sums += dome_sums(&dome, rays + ray, occlusions[ray], params.scale);
      value += rays[ray].weight * occlusions[ray].transmittance / params.rays;
    }
    add_to_batch(&batches, s, value);
  }
  const uint pixel = pixel_of(work, params, local_pixel);
  add_squares(squares, params, pixel, &batches);
  add_to_planes(film, params, 8u, pixel, sums);
}
