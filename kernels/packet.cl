/* The occlusion pass for packets: one group of a point's rays an item, with results as
   those of occlusion.cl. */
#include "packet.clh"

/* Part `index` of `total` shared over `count` without remainder. */
inline uint share(uint total, uint index, uint count) {
  return total * (index + 1u) / count - total * index / count;
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
  Packet packet;
  start_packet(count, &packet);
  traverse_packet(scene, params, rays[first].light, &world, &packet);
  for (uint i = 0; i < count; ++i) {
    results[first + i].transmittance = packet_transmittance(&packet, i);
    results[first + i].visits = min(share(packet.visits, i, count), 65535u) |
                                min(share(packet.tests, i, count), 65535u) << 16;
  }
}
