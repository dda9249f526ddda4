/* The occlusion pass for packets: one group of a point's rays an item, results as those of
   occlusion.cl. */
#include "packet.clh"

/* Part `index` of `total` shared over `count` without remainder. */
inline uint share(uint total, uint index, uint count) {
  return total * (index + 1u) / count - total * index / count;
}

/* Rays lie as points * rays_per_point; each point's are cut into groups of about the same
   size, no larger than a bundle. A group's node visits and triangle tests are counted once
   and shared over its rays. */
__kernel void packet(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                     __global const TexturedTriangle* textured,
                     __global const TextureRecord* textures, __global const uchar* texels,
                     __global const InstanceRecord* instances, __global const Ray* rays,
                     __global Occlusion* results, OcclusionParams params) {
  const uint groups = (params.rays_per_point + DAPPLE_BUNDLE_RAYS - 1u) / DAPPLE_BUNDLE_RAYS;
  const uint item = get_global_id(0);
  if (item >= params.ray_count / params.rays_per_point * groups) return;
  const uint size = (params.rays_per_point + groups - 1u) / groups;
  const uint skipped = item % groups * size;
  const uint first = item / groups * params.rays_per_point + skipped;
  const uint count = min(size, params.rays_per_point - skipped);
  const Scene scene = {nodes, blocks, textured, textures, texels, instances};
  Packet packet;
  Bundle world;
  load_rays(rays + first, count, params.footprint, &packet, &world);
  const PacketWork work = traverse_packet(scene, params, rays[first].light, &world, &packet);
  for (uint i = 0; i < count; ++i) {
    const uint cell = packet.place[i] / 8u, lane = packet.place[i] % 8u;
    const float transmittance = packet.surfaces[cell].f[lane] * exp(-packet.depth[cell].f[lane]);
    results[first + i].transmittance = transmittance < DAPPLE_OPAQUE_ENOUGH ? 0.0f : transmittance;
    results[first + i].visits = min(share(work.visits, i, count), 65535u) |
                                min(share(work.tests, i, count), 65535u) << 16;
  }
}
