/* The occlusion pass with ray packets: traces up to 64 rays together, either rays that share their
   origin (point packets) or rays of neighbouring pixels (pixel packets). In: the scene and the ray
   queue. Out: the transmittance of each ray in queue order, as occlusion.cl computes it. Work-items
   take tickets (vectors/tickets.clh); a ticket is one or more ray batches. */
#include "occlusion/packet.clh"
#include "occlusion/packet_order.clh"
#include "vectors/tickets.clh"

/* Divides `total` over the `count` rays of a packet so that the shares add up to the total and
   differ by at most one. */
typedef struct Shares {
  uint each, more, over, count;
} Shares;

inline Shares make_shares(uint total, uint count) {
  const Shares shares = {total / count, total % count, 0u, count};
  return shares;
}

/* The share of the next ray. */
inline uint next_share(Shares* shares) {
  shares->over += shares->more;
  const uint one = shares->over >= shares->count;
  shares->over -= one ? shares->count : 0u;
  return shares->each + one;
}

/* Traces rays queue[order[0]] to queue[order[count - 1]] as one packet. Node visits and triangle tests
   are counted once for the packet and divided over its rays. */
inline void trace_packet(Scene scene, OcclusionParams params, __global const Ray* queue,
                         const ushort* order, uint count, __global Occlusion* results) {
  Packet packet;
  traverse_rays(scene, params, queue, order, count, &packet);
  Shares visits = make_shares(packet.visits, count);
  Shares tests = make_shares(packet.tests, count);
  for (uint i = 0; i < count; i += 8u) {
    Lanes transmittance;
    transmittance.v = packet_transmittance(params, &packet, i);
    for (uint lane = 0; lane < min(8u, count - i); ++lane) {
      __global Occlusion* result = results + order[i + lane];
      result->transmittance = transmittance.f[lane];
      result->visits = pack_costs(next_share(&visits), next_share(&tests));
    }
  }
}

/* Sorts the batch of `count` rays at `rays`, at most DAPPLE_RAY_BATCH, and traces it packet by packet.
   Rays with t_max <= 0 get transmittance 1. */
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
/* Point packets: the queue holds rays_per_point rays of each point in turn. The rays of a point are
   split into batches of about the same size; a ticket is batches_per_ticket consecutive batches. */
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
/* Pixel packets: a ticket is one batch of rays of neighbouring pixels. Returns the index of its first
   ray. The last batches are small, so that all work-items end at about the same time. */
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
