/* The occlusion pass for packets: rays that follow one another in the queue, those of one point or
   of neighbours, go 64 at a time, with results as those of occlusion.cl. */
#include "occlusion/packet.clh"
#include "occlusion/packet_order.clh"
#include "vectors/tickets.clh"

/* A count shared over a packet's rays without remainder. */
typedef struct Shares {
  uint each, more, over, count;
} Shares;

inline Shares make_shares(uint total, uint count) {
  const Shares shares = {total / count, total % count, 0u, count};
  return shares;
}

inline uint next_share(Shares* shares) {
  shares->over += shares->more;
  const uint one = shares->over >= shares->count;
  shares->over -= one ? shares->count : 0u;
  return min(shares->each + one, 65535u);
}

/* Rays queue[order[0]] to queue[order[count - 1]]. Node visits and triangle tests are counted once
   and shared over them. */
inline void trace_packet(Scene scene, OcclusionParams params, __global const Ray* queue,
                         const ushort* order, uint count, __global Occlusion* results) {
  Packet packet;
  traverse_rays(scene, params, queue, order, count, &packet);
  Shares visits = make_shares(packet.visits, count);
  Shares tests = make_shares(packet.tests, count);
  for (uint i = 0; i < count; i += 8u) {
    Lanes transmittance;
    transmittance.v = packet_transmittance(&packet, i);
    for (uint lane = 0; lane < min(8u, count - i); ++lane) {
      __global Occlusion* result = results + order[i + lane];
      result->transmittance = transmittance.f[lane];
      result->visits = next_share(&visits) | next_share(&tests) << 16;
    }
  }
}

/* `count` rays from the first one on, at most DAPPLE_RAY_BATCH. */
inline void trace_batch(Scene scene, OcclusionParams params, __global const Ray* rays, uint count,
                        __global Occlusion* results) {
  ushort order[DAPPLE_RAY_BATCH];
  const uint traced = order_batch(rays, count, order);
  for (uint i = 0; i < traced; i += DAPPLE_PACKET_RAYS)
    trace_packet(scene, params, rays, order + i, min(traced - i, DAPPLE_PACKET_RAYS), results);
  for (uint i = traced; i < count; ++i) {
    results[order[i]].transmittance = 1.0f;
    results[order[i]].visits = 0u;
  }
}

#if DAPPLE_SHARED_ORIGIN
/* Rays lie as points * rays_per_point. The rays of a point are cut into batches of about the same size; a
   ticket stands for several batches in a row. */
inline void trace_ticket(Scene scene, OcclusionParams params, uint ticket, __global const Ray* rays,
                        __global Occlusion* results) {
  const uint of_point = (params.rays_per_point + DAPPLE_RAY_BATCH - 1u) / DAPPLE_RAY_BATCH;
  const uint size = (params.rays_per_point + of_point - 1u) / of_point;
  const uint batches = params.ray_count / params.rays_per_point * of_point;
  const uint end = min((ticket + 1u) * params.batches_per_ticket, batches);
  for (uint batch = ticket * params.batches_per_ticket; batch < end; ++batch) {
    const uint skipped = batch % of_point * size;
    const uint first = batch / of_point * params.rays_per_point + skipped;
    const uint count = min(size, params.rays_per_point - skipped);
    if (batch + 1u < end) prefetch_rays(rays + first + count, min(count, DAPPLE_PACKET_RAYS));
    trace_batch(scene, params, rays + first, count, results + first);
  }
}
#else
/* A ticket stands for one batch of rays of neighbouring pixels. The last batches are small, so that all
   work-items end at about the same time. */
inline uint start_of_ticket(OcclusionParams params, uint ticket) {
  const uint large = min(ticket, params.large_batches);
  return min(large * DAPPLE_RAY_BATCH + (ticket - large) * DAPPLE_SMALL_RAY_BATCH, params.ray_count);
}

inline void trace_ticket(Scene scene, OcclusionParams params, uint ticket, __global const Ray* rays,
                        __global Occlusion* results) {
  const uint first = start_of_ticket(params, ticket);
  trace_batch(scene, params, rays + first, start_of_ticket(params, ticket + 1u) - first,
              results + first);
}
#endif

__kernel void packet(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                     __global const SegmentBlock* segments,
                     __global const TexturedTriangle* textured,
                     __global const MaterialRecord* materials, __global const uchar* texels,
                     __global const InstanceRecord* instances, __global const Ray* rays,
                     __global Occlusion* results, OcclusionParams params, __global uint* tickets,
                     uint first_ticket, uint ticket_count) {
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  for (uint ticket; (ticket = take_ticket(tickets, first_ticket)) < ticket_count;)
    trace_ticket(scene, params, ticket, rays, results);
}
