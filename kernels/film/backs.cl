/* Chooses the samples whose backs are traced, one in each group of 2^group_bits samples of a pixel. In: the
   surface points of a slice, before the shading pass. Out: the chosen points, turned to the other side, and
   which of them hit; planes with the numbers of both. */
#include "film/film.clh"
#include "sampling/random.clh"

/* The chosen sample of a pixel's group. Its place in the group moves on by one from group to group, so that
   all surfaces are chosen equally often where several samples share a camera ray. */
inline uint chosen_sample(BackParams params, uint pixel, uint group) {
  const uint shift = hash_pair(pixel, params.seed ^ 0x2f8ac1d3u);
  return (group << params.group_bits) + ((group + shift) & ((1u << params.group_bits) - 1u));
}

/* One work-item for each record. A turned point is numbered among those of its pixel, so that its rays are
   stratified with theirs. Points that are not chosen are left as they are. */
__kernel void turn_points(__global const SurfacePoint* points, __global const SampleHits* sample_hits,
                          __global SurfacePoint* turned, __global SampleHits* turned_hits,
                          BackParams params) {
  const uint record = get_global_id(0);
  const uint samples = params.resolve.slice.pixel_count * params.resolve.slice.sample_count;
  if (record * DAPPLE_HIT_BITS >= samples) return;
  uint chosen = 0u;
  for (uint left = sample_hits[record].hits; left; left &= left - 1u) {
    const uint lane = lowest_bit(left), at = record * DAPPLE_HIT_BITS + lane;
    const uint sample = points[at].sample, group = sample >> params.group_bits;
    if (sample != chosen_sample(params, points[at].pixel, group)) continue;
    chosen |= 1u << lane;
    SurfacePoint point = points[at];
    point.sample = group;
    for (uint axis = 0; axis < 3u; ++axis) point.normal[axis] = -point.normal[axis];
    turned[at] = point;
  }
  const SampleHits hits = {chosen, 0u, 0u, 0u};
  turned_hits[record] = hits;
}

/* Planes: chosen samples, and those of them that hit. */
__kernel void count_backs(__global const PixelWork* work, __global const SampleHits* turned_hits,
                          __global long* film, BackParams params) {
  const uint local_pixel = get_global_id(0);
  const SliceParams slice = params.resolve.slice;
  if (local_pixel >= slice.pixel_count) return;
  const PixelWork of = work[slice.first_work + local_pixel];
  const uint pixel = (params.crop_y + of.pixel / params.crop_width) * params.width + params.crop_x +
                     of.pixel % params.crop_width;
  const uint first = of.first_sample + slice.first_sample, last = first + slice.sample_count - 1u;
  uint chosen = 0u, hits = 0u;
  for (uint group = first >> params.group_bits; group <= last >> params.group_bits; ++group) {
    const uint sample = chosen_sample(params, pixel, group);
    chosen += sample >= first && sample <= last ? 1u : 0u;
  }
  if (!chosen) return;
  const uint begin = local_pixel * slice.sample_count, end = begin + slice.sample_count;
  for (uint r = begin / DAPPLE_HIT_BITS; r * DAPPLE_HIT_BITS < end; ++r)
    hits += popcount(turned_hits[r].hits & range_of_samples(r, begin, end));
  add_to_plane(film, params.resolve, 0u, of.pixel, (long)chosen);
  add_to_plane(film, params.resolve, 1u, of.pixel, (long)hits);
}
