/* The camera pass: intersects the camera rays of a slice with the scene, one packet per work-item. In: the
   scene, the camera and the slice's pixels. Out: for each sample whether it hits, and its surface point.
   DAPPLE_SHARED_ORIGIN 1: perspective cameras without a lens; 0: other ones. */
#include "camera/surface_points16.clh"
#include "camera/camera.clh"
#include "camera/closest_search.clh"
#include "vectors/tickets.clh"

#define DAPPLE_MAX_RECORDS (DAPPLE_ITEM_RAYS * DAPPLE_MAX_CAMERA_SPLITTING / DAPPLE_HIT_BITS)

/* Results of a work-item: bits of the samples that hit, as in SampleHits, and the costs. */
typedef struct ItemHits {
  uint hits[DAPPLE_MAX_RECORDS];
  uint visits, tests;  /* as in SampleHits */
} ItemHits;

/* The item's sixteen rays from `first` on. Rays beyond `count` have t_max <= 0. */
inline void start_group(CameraParams params, const CameraSamples* chosen, uint first, uint count,
                       ClosestHits16* closest, StochasticHits* stops) {
  for (uint i = 0; i < DAPPLE_GROUP_RAYS; ++i)
    closest->t.f[i] = first + i < count ? INFINITY : 0.0f;
  stops->count = 1u << params.splitting_bits;
  float16 min_threshold = (float16)(1.0f);
  for (uint d = 0; d < stops->count; ++d) {
    stops->threshold[d] = vload16(0, chosen->threshold[d] + first);
    stops->t[d].v = (float16)(INFINITY);
    stops->primitive[d].v = stops->instance[d].v = (int16)(0);
    min_threshold = min(min_threshold, stops->threshold[d]);
  }
  start_k_buffer(min_threshold, &closest->k_buffer);
  closest->primitive.v = closest->instance.v = (int16)(0);
}

/* Of the ray in lane `ray` of the points; `of_item` is its index in `chosen`. `keep_hit`: for the shading
   pass, `t` becomes the bits of the hit's instance, and `visits` its primitive. */
inline void store_stochastic_hit(const CameraSamples* chosen, uint of_item, uint sample, uint ray,
                                 SurfaceHit hit, bool keep_hit, float area,
                                 const SurfacePoints16* at, __global SurfacePoint* point) {
  vstore4((float4)(at->position[0].f[ray], at->position[1].f[ray], at->position[2].f[ray],
                   keep_hit ? as_float(hit.instance) : hit.t),
          0, point->position);
  vstore4((float4)(at->normal[0].f[ray], at->normal[1].f[ray], at->normal[2].f[ray],
                   at->offset.f[ray]),
          0, point->normal);
  vstore4((uint4)(as_uint(area), chosen->pixel[of_item], chosen->sample[of_item] + sample,
                  keep_hit ? hit.primitive : 0u),
          0, (__global uint*)&point->area);
}

/* Stores the hits of the group whose first ray is `first`, for each sample; `points` are the item's. */
inline void store_group(Scene scene, const CameraSamples* chosen, uint first, const Rays16* group,
                       const CameraShares16* shares, const uint* keys, const StochasticHits* stops,
                       bool keep_hits, __global SurfacePoint* points, ItemHits* found) {
  SurfacePoints16 at;
  clear_points(&at);
  for (uint d = 0; d < stops->count; ++d) {
    const float16 t = stops->t[d].v;
    const int16 hit = t < INFINITY;
    const uint hits = bits_of_16(hit);
    if (!hits) return; /* later samples have lower thresholds, so they do not hit either */
    uint others = hits;
    if (d)
      others &= bits_of_16((stops->primitive[d].v != stops->primitive[d - 1u].v) |
                           (stops->instance[d].v != stops->instance[d - 1u].v));
    if (others) store_hit_points(scene, group, keys, stops, d, hits, &at);
    Floats16 area;
    area.v = shares->first_area.v + shares->solid_angle.v * t * t;
    for (uint left = hits; left; left &= left - 1u) {
      const uint ray = lowest_bit(left);
      const uint slot = (first + ray) * stops->count + d;
      const SurfaceHit hit_of_ray = {stops->t[d].f[ray], (uint)stops->primitive[d].i[ray],
                                     (uint)stops->instance[d].i[ray]};
      store_stochastic_hit(chosen, first + ray, d, ray, hit_of_ray, keep_hits, area.f[ray], &at,
                           points + slot);
      found->hits[slot / DAPPLE_HIT_BITS] |= 1u << slot % DAPPLE_HIT_BITS;
    }
  }
}

/* The number of pixels that a medium's box may cover varies randomly, as footprints do, so that nothing
   pops. */
inline void set_medium(CameraParams params, const CameraShares16* shares, ClosestPacket* packet) {
  packet->medium_error = params.medium_error;
  packet->share_of_sample = 1.0f / (1u << params.splitting_bits);
  for (uint b = 0; b < DAPPLE_PACKET_GROUPS; ++b) {
    const float16 scale = DAPPLE_MAX_MEDIUM_PIXELS / params.inverse_spp * shares[b].spread.v;
    Floats16 first_area, solid_angle;
    first_area.v = scale * shares[b].first_area.v;
    solid_angle.v = 0.25f * scale * shares[b].solid_angle.v; /* a quarter, as in PacketRay */
    PacketRay* rays = packet->world.rays + b * DAPPLE_GROUP_RAYS;
    for (uint i = 0; i < DAPPLE_GROUP_RAYS; ++i) {
      rays[i].first_area = first_area.f[i];
      rays[i].solid_angle = solid_angle.f[i];
    }
  }
}

/* Intersects the item's `count` rays with the scene. */
inline void trace_rays(Scene scene, CameraParams params, const CameraSamples* chosen,
                       const Entries* entries, uint count, __global SurfacePoint* points,
                       ItemHits* found) {
  Rays16 groups[DAPPLE_PACKET_GROUPS];
  FilterTaps taps[DAPPLE_PACKET_GROUPS];
  CameraShares16 shares[DAPPLE_PACKET_GROUPS];
  StochasticHits stops[DAPPLE_PACKET_GROUPS];
  ClosestPacket packet;
  packet.groups = groups;
  for (uint b = 0; b < DAPPLE_PACKET_GROUPS; ++b) {
    const uint first = b * DAPPLE_GROUP_RAYS;
    aim(params, chosen, first, taps + b, groups + b, shares + b, packet.key + first);
    start_group(params, chosen, first, count, packet.closest + b, stops + b);
  }
  set_medium(params, shares, &packet);
  find_closest(scene, params.scene, entries, &packet, stops);
  for (uint b = 0; b < DAPPLE_PACKET_GROUPS; ++b) {
    const uint first = b * DAPPLE_GROUP_RAYS;
    store_group(scene, chosen, first, groups + b, shares + b, packet.key + first, stops + b,
                params.keep_hits != 0u, points, found);
  }
  found->visits += packet.visits;
  found->tests += packet.tests;
}

/* Traces the rays of one item, of `rays` in all. Points of samples that miss are not written. */
DAPPLE_INLINE void trace_item(Scene scene, CameraParams params, uint item, uint rays,
                              __global const PixelWork* work, __global SurfacePoint* points,
                              __global SampleHits* sample_hits) {
  const uint begin = item * DAPPLE_ITEM_RAYS;
  const uint count = min(rays - begin, DAPPLE_ITEM_RAYS);
  Entries entries;
  entries.count = entries.visits = 0u;
  const PixelBounds pixels = pixels_of_rays(work, params, begin, count);
  if (may_see_scene(params, pixels)) {
    IntervalBounds bounds;
    bound_pixels(params, pixels, &bounds);
    find_entries(scene, params.scene, params.medium_error > 0.0f, &bounds, &entries);
  }
  const uint first_sample = begin << params.splitting_bits;
  const uint rays_of_record = DAPPLE_HIT_BITS >> params.splitting_bits;
  const uint records = (count + rays_of_record - 1u) / rays_of_record;
  ItemHits found;
  for (uint record = 0; record < DAPPLE_MAX_RECORDS; ++record) found.hits[record] = 0u;
  found.visits = entries.visits;
  found.tests = 0u;
  if (entries.count) {
    CameraSamples chosen;
    choose_samples(work, params, begin, count, &chosen);
    trace_rays(scene, params, &chosen, &entries, count, points + first_sample, &found);
  }
  for (uint record = 0; record < records; ++record) {
    const SampleHits of_samples = {found.hits[record], 0u, found.visits, found.tests};
    sample_hits[first_sample / DAPPLE_HIT_BITS + record] = of_samples;
  }
}

__kernel void camera_hits(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                          __global const SegmentBlock* segments,
                          __global const TexturedTriangle* textured,
                          __global const MaterialRecord* materials, __global const uchar* texels,
                          __global const InstanceRecord* instances,
                          __global const PixelWork* work, __global SurfacePoint* points,
                          __global SampleHits* sample_hits, CameraParams params,
                          __global uint* tickets, uint first_ticket, uint ticket_count) {
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  const uint rays = params.slice.pixel_count * rays_of_pixel(params);
  const uint items = (rays + DAPPLE_ITEM_RAYS - 1u) / DAPPLE_ITEM_RAYS;
  for (uint ticket; (ticket = take_ticket(tickets, first_ticket)) < ticket_count;) {
    const uint end = min((ticket + 1u) * DAPPLE_ITEMS_PER_TICKET, items);
    for (uint item = ticket * DAPPLE_ITEMS_PER_TICKET; item < end; ++item)
      trace_item(scene, params, item, rays, work, points, sample_hits);
  }
}
