/* The occlusion pass for packets: an item traces rays that follow one another in the queue, those of
   one point or of neighbours, 64 at a time, with results as those of occlusion.cl. */
#include "deal.clh"
#include "packet.clh"
#include "packet_order.clh"

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
  PacketRays world;
  load_rays(queue, order, count, params.footprint, &world);
  Packet packet;
  start_packet(count, &packet);
  traverse_packet(scene, params, queue[order[0]].light, &world, &packet);
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

/* Rays lie as points * rays_per_point; each point's are cut into chunks of about the same size, of
   at most DAPPLE_PACKET_CHUNK, one an item. */
__kernel void packet(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                     __global const SegmentBlock* segments,
                     __global const TexturedTriangle* textured,
                     __global const MaterialRecord* materials, __global const uchar* texels,
                     __global const InstanceRecord* instances, __global const Ray* rays,
                     __global Occlusion* results, OcclusionParams params) {
  const uint chunks = (params.rays_per_point + DAPPLE_PACKET_CHUNK - 1u) / DAPPLE_PACKET_CHUNK;
  const uint item = get_global_id(0);
  if (item >= params.ray_count / params.rays_per_point * chunks) return;
  const uint size = (params.rays_per_point + chunks - 1u) / chunks;
  const uint skipped = deal(item % chunks, chunks) * size;
  const uint first = item / chunks * params.rays_per_point + skipped;
  const uint count = min(size, params.rays_per_point - skipped);
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  /* Those that the thread takes next. */
  const uint next = chunks > 1u ? deal(min(item % chunks + 1u, chunks - 1u), chunks) * size : count;
  prefetch_rays(rays + first - skipped + next, min(count, DAPPLE_PACKET_RAYS));
  ushort order[DAPPLE_PACKET_CHUNK];
  uint traced = count;
  if (count > DAPPLE_PACKET_RAYS) {
    traced = order_rays(rays + first, count, order);
  } else {
    for (uint i = 0; i < count; ++i) order[i] = (ushort)i;
  }
  for (uint i = 0; i < traced; i += DAPPLE_PACKET_RAYS) {
    trace_packet(scene, params, rays + first, order + i, min(traced - i, DAPPLE_PACKET_RAYS),
                 results + first);
  }
  for (uint i = traced; i < count; ++i) {
    results[first + order[i]].transmittance = 1.0f;
    results[first + order[i]].visits = 0u;
  }
}
