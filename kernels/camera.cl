/* The camera pass: where the slice's camera rays meet the scene, a beam of them an item. */
#include "beam_nearest.clh"
#include "camera.clh"
#include "deal.clh"
#include "surface_point.clh"

/* Stores what ray i of a beam met; `sample` is its place among those of `chosen`. */
inline void store_hit(Scene scene, const CameraSamples* chosen, uint sample, const BeamRays* rays,
                      const float* area, BeamNearest* nearest, uint i,
                      __global SurfacePoint* point) {
  const float3 direction = (float3)(((const float*)&rays->direction[0])[i],
                                    ((const float*)&rays->direction[1])[i],
                                    ((const float*)&rays->direction[2])[i]);
  const float3 origin = (float3)(((const float*)&rays->origin[0])[i],
                                 ((const float*)&rays->origin[1])[i],
                                 ((const float*)&rays->origin[2])[i]);
  store_point(scene, hit_of_ray(nearest, i), origin, direction, area[i], point);
  point->pixel = chosen->pixel[sample];
  point->sample = chosen->sample[sample];
}

#define DAPPLE_ITEM_RECORDS (DAPPLE_ITEM_SAMPLES / DAPPLE_HIT_BITS)

/* What an item found: its samples that hit, by place, and for each SampleHits the sums over its
   samples of what their beams cost. */
typedef struct ItemHits {
  ulong hits;
  uint visits[DAPPLE_ITEM_RECORDS], tests[DAPPLE_ITEM_RECORDS];
} ItemHits;

/* Where the rays of one beam meet the scene: the samples of `chosen` from `first` on, but for those
   that are not among the item's `count`. `points` are those of the item. */
inline void trace_beam(Scene scene, CameraParams params, const CameraSamples* chosen,
                       const Entries* entries, uint first, uint count,
                       __global SurfacePoint* points, ItemHits* found) {
  BeamRays rays;
  float16 solid_angle, first_area;
  aim(params, chosen->x + first, chosen->y + first, &rays, &solid_angle, &first_area);
  BeamNearest nearest;
  for (uint i = 0; i < DAPPLE_BEAM_RAYS; ++i)
    nearest.t.f[i] = chosen->place[first + i] < count ? INFINITY : 0.0f;
  start_layers(vload16(0, chosen->threshold + first), &nearest.layers);
  nearest.primitive.v = nearest.instance.v = (int16)(0);
  nearest.farthest = INFINITY;
  nearest.visits = nearest.tests = 0u;
  find_nearest(scene, params.scene, entries, &rays, &nearest);
  BeamFloats area;
  area.v = first_area + solid_angle * nearest.t.v * nearest.t.v;
  for (uint i = 0; i < DAPPLE_BEAM_RAYS; ++i) {
    const uint place = chosen->place[first + i], record = place / DAPPLE_HIT_BITS;
    found->visits[record] += place < count ? nearest.visits : 0u;
    found->tests[record] += place < count ? nearest.tests : 0u;
  }
  for (uint left = bits_of_rays((nearest.t.v > 0.0f) & (nearest.t.v < INFINITY)); left;
       left &= left - 1u) {
    const uint i = lowest_bit(left), place = chosen->place[first + i];
    found->hits |= 1UL << place;
    store_hit(scene, chosen, first + i, &rays, area.f, &nearest, i, points + place);
  }
}

/* Points of samples that miss are left as they are. */
__kernel void camera_hits(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const SegmentBlock* segments,
                          __global const TexturedTriangle* textured,
                          __global const MaterialRecord* materials, __global const uchar* texels,
                          __global const InstanceRecord* instances,
                          __global const PixelWork* work, __global SurfacePoint* points,
                          __global SampleHits* sample_hits, CameraParams params) {
  const uint samples = params.slice.pixel_count * params.slice.sample_count;
  const uint items = (samples + DAPPLE_ITEM_SAMPLES - 1u) / DAPPLE_ITEM_SAMPLES;
  const uint begin = deal_runs(get_global_id(0), items, DAPPLE_RUN_ITEMS) * DAPPLE_ITEM_SAMPLES;
  if (begin >= samples) return;
  const uint count = min(samples - begin, DAPPLE_ITEM_SAMPLES);
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  Entries entries;
  entries.count = entries.visits = 0u;
  const PixelBounds pixels = pixels_of_samples(work, params, begin, count);
  if (may_see_scene(params, pixels)) {
    BeamBounds bounds;
    bound_pixels(params, pixels, &bounds);
    find_entries(scene, params.scene, &bounds, &entries);
  }
  ItemHits found;
  found.hits = 0UL;
  for (uint record = 0; record < DAPPLE_ITEM_RECORDS; ++record)
    found.visits[record] = found.tests[record] = 0u;
  if (entries.count) {
    CameraSamples chosen, sorted;
    choose_samples(work, params, begin, count, &chosen);
    sort_samples(&chosen, &sorted);
    for (uint first = 0; first < DAPPLE_ITEM_SAMPLES; first += DAPPLE_BEAM_RAYS) {
      trace_beam(scene, params, &sorted, &entries, first, count, points + begin, &found);
    }
  }
  for (uint record = 0; record * DAPPLE_HIT_BITS < count; ++record) {
    const uint of_record = min(count - record * DAPPLE_HIT_BITS, DAPPLE_HIT_BITS);
    /* Nodes that all beams visited together are shared out. */
    const uint of_entries = (entries.visits + DAPPLE_ITEM_RECORDS - 1u - record) / DAPPLE_ITEM_RECORDS;
    const SampleHits of_samples = {(uint)(found.hits >> record * DAPPLE_HIT_BITS) & 65535u, 0u,
                                   found.visits[record] / of_record + of_entries,
                                   found.tests[record] / of_record};
    sample_hits[begin / DAPPLE_HIT_BITS + record] = of_samples;
  }
}
