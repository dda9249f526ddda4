/* The occlusion pass for packets: one group of a point's rays an item, with results as
   those of occlusion.cl. */
#include "packet.clh"

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

/* Rays lie as points * rays_per_point; each point's are cut into groups of about the same
   size, of at most DAPPLE_PACKET_RAYS. A group's node visits and triangle tests are counted once
   and shared over its rays. */
__kernel void packet(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                     __global const TexturedTriangle* textured,
                     __global const TextureRecord* textures, __global const uchar* texels,
                     __global const InstanceRecord* instances, __global const Ray* rays,
                     __global Occlusion* results, OcclusionParams params) {
  const uint groups = (params.rays_per_point + DAPPLE_PACKET_RAYS - 1u) / DAPPLE_PACKET_RAYS;
  const uint item = get_global_id(0);
  if (item >= params.ray_count / params.rays_per_point * groups) return;
  const uint size = (params.rays_per_point + groups - 1u) / groups;
  const uint skipped = item % groups * size;
  const uint first = item / groups * params.rays_per_point + skipped;
  const uint count = min(size, params.rays_per_point - skipped);
  const Scene scene = {nodes, blocks, textured, textures, texels, instances};
  PacketRays world;
  load_rays(rays + first, count, params.footprint, &world);
  prefetch_rays(rays + first + count, count);
  Packet packet;
  start_packet(count, &packet);
  traverse_packet(scene, params, rays[first].light, &world, &packet);
  Shares visits = make_shares(packet.visits, count);
  Shares tests = make_shares(packet.tests, count);
  for (uint i = 0; i < count; i += 8u) {
    Lanes transmittance;
    transmittance.v = packet_transmittance(&packet, i);
    for (uint lane = 0; lane < min(8u, count - i); ++lane) {
      results[first + i + lane].transmittance = transmittance.f[lane];
      results[first + i + lane].visits = next_share(&visits) | next_share(&tests) << 16;
    }
  }
}
