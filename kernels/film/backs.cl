/* Chooses the samples whose backs are traced, one in each group of 2^group_bits samples of a pixel. In: the
   surface points of a slice, before the shading pass. Out: the chosen points, flipped to the other side and
   packed, and which of them hit; planes with the numbers of both. */
#include "film/film.clh"
#include "sampling/random.clh"

/* The groups that a pixel's samples of a slice belong to. A packed slice has params.slots samples of a
   pixel; sample i is that of the group first_group + i, and none if the pixel has no such group or the
   group's chosen sample lies in another slice. */
typedef struct GroupedSamples {
  uint pixel;        /* in the whole picture, row-major */
  uint first_sample; /* of the pixel's in the slice */
  uint first_group;
} GroupedSamples;

inline GroupedSamples grouped_samples(BackParams params, PixelWork work) {
  GroupedSamples of;
  of.pixel = (params.crop_y + work.pixel / params.crop_width) * params.width + params.crop_x +
             work.pixel % params.crop_width;
  of.first_sample = work.first_sample + params.resolve.slice.first_sample;
  of.first_group = of.first_sample >> params.group_bits;
  return of;
}

/* The chosen sample of a group, counted from the pixel's first in the slice; in other slices it is at least
   sample_count. Its place in the group moves on by one from group to group, so that all surfaces are chosen
   equally often where several samples share a camera ray. */
inline uint chosen_sample(BackParams params, GroupedSamples of, uint slot) {
  const uint group = of.first_group + slot, shift = hash_pair(of.pixel, params.seed ^ 0x2f8ac1d3u);
  return (group << params.group_bits) + ((group + shift) & ((1u << params.group_bits) - 1u)) - of.first_sample;
}

/* One work-item for each record of the packed slice. A flipped point is numbered among those of its pixel,
   so that its rays are stratified with theirs. */
__kernel void flip_points(__global const PixelWork* work, __global const SurfacePoint* points,
                          __global const SampleHits* sample_hits, __global SurfacePoint* flipped,
                          __global SampleHits* flipped_hits, BackParams params) {
  const SliceParams slice = params.resolve.slice;
  const uint begin = get_global_id(0) * DAPPLE_HIT_BITS, first = params.first_packed + begin;
  const uint end = min(begin + DAPPLE_HIT_BITS, slice.pixel_count * params.slots);
  if (begin >= end) return;
  uint hits = 0u, local_pixel = begin / params.slots, slot = begin % params.slots;
  for (uint at = begin; at < end; ++local_pixel, slot = 0u) {
    const uint from = local_pixel * slice.sample_count, slots = min(params.slots - slot, end - at);
    at += slots;
    if (!any_sample_hit(sample_hits, from, from + slice.sample_count)) continue;
    const GroupedSamples of = grouped_samples(params, work[slice.first_work + local_pixel]);
    for (uint i = 0; i < slots; ++i) {
      const uint sample = chosen_sample(params, of, slot + i), lane = at - slots + i - begin;
      if (sample >= slice.sample_count || !sample_hit(sample_hits, from + sample)) continue;
      hits |= 1u << lane;
      SurfacePoint point = points[from + sample];
      point.sample = of.first_group + slot + i;
      for (uint axis = 0; axis < 3u; ++axis) point.normal[axis] = -point.normal[axis];
      flipped[first + lane] = point;
    }
  }
  const SampleHits of_record = {hits, 0u, 0u, 0u};
  flipped_hits[first / DAPPLE_HIT_BITS] = of_record;
}

/* Planes: chosen samples, and those of them that hit. */
__kernel void count_backs(__global const PixelWork* work, __global const SampleHits* flipped_hits,
                          __global long* film, BackParams params) {
  const uint local_pixel = get_global_id(0);
  const SliceParams slice = params.resolve.slice;
  if (local_pixel >= slice.pixel_count) return;
  const PixelWork entry = work[slice.first_work + local_pixel];
  const GroupedSamples of = grouped_samples(params, entry);
  uint chosen = 0u, hits = 0u;
  for (uint slot = 0; slot < params.slots; ++slot) {
    chosen += chosen_sample(params, of, slot) < slice.sample_count ? 1u : 0u;
    hits += sample_hit(flipped_hits, local_pixel * params.slots + slot) ? 1u : 0u;
  }
  if (!chosen) return;
  const FilmPixel pixel = film_pixel(work, params.resolve, local_pixel);
  add_to_plane(film, params.resolve, DAPPLE_PLANE_BACK_CHOSEN, pixel, (long)chosen);
  if (hits) add_to_plane(film, params.resolve, DAPPLE_PLANE_BACK_HITS, pixel, (long)hits);
}
