/* AO of points with few rays: the work-item that takes a point makes its rays, traces them together and
   adds them up, with no queue between. What a ray finds is what packet.cl finds. */
#include "occlusion/ao_rays.clh"
#include "occlusion/packet.clh"
#include "occlusion/packet_order.clh"
#include "vectors/tickets.clh"

/* Transmittances are added up in steps of 2^-40, exactly, so in any order. */
#define DAPPLE_AO_STEPS 1099511627776.0f

/* Of the packet's first rays. */
inline long sum_transmittances(const Packet* packet, uint count) {
  long8 sums = (long8)(0);
  for (uint i = 0; i < count; i += 8u) {
    const int8 counts = (int8)(0, 1, 2, 3, 4, 5, 6, 7) < (int)(count - i);
    const float8 seen = counts ? packet_transmittance(packet, i) : (float8)(0.0f);
    sums += convert_long8(seen * DAPPLE_AO_STEPS);
  }
  const long4 four = sums.lo + sums.hi;
  return four.x + four.y + four.z + four.w;
}

/* Of a point's rays, [0,1]. */
inline float mean_transmittance(Scene scene, OcclusionParams params, __global const Ray* rays,
                                uint count) {
  ushort order[DAPPLE_RAY_BATCH];
  const uint traced = order_batch(rays, count, order);
  long sum = (count - traced) * (long)DAPPLE_AO_STEPS;
  for (uint i = 0; i < traced; i += DAPPLE_PACKET_RAYS) {
    const uint together = min(traced - i, DAPPLE_PACKET_RAYS);
    Packet packet;
    traverse_rays(scene, params, rays, order + i, together, &packet);
    sum += sum_transmittances(&packet, together);
  }
  return (float)sum / (DAPPLE_AO_STEPS * (float)count);
}

inline void make_rays_of(__global const SurfacePoint* point, AoParams params,
                         __global Ray* rays) {
  for (uint first = 0; first < params.rays; first += DAPPLE_RAY_LANES) {
    PointRays chosen;
    load_point(point, params.rays, first, params.rays, &chosen);
    make_ao_rays(&chosen, params, rays + first);
  }
}

/* `scratch` holds a point's rays for each work-group, of one item; `params.batches_per_ticket` points are
   a piece. */
__kernel void point_ao(__global const BvhNode* nodes, __global const TriangleBlock* blocks,
                       __global const SegmentBlock* segments,
                       __global const TexturedTriangle* textured,
                       __global const MaterialRecord* materials, __global const uchar* texels,
                       __global const InstanceRecord* instances,
                       __global const SurfacePoint* points, __global Ray* scratch,
                       __global float* ao, AoParams ao_params, OcclusionParams params,
                       __global uint* tickets, uint first_ticket, uint ticket_count) {
  const Scene scene = {nodes, blocks, segments, textured, materials, texels, instances};
  __global Ray* rays = scratch + get_group_id(0) * ao_params.rays;
  for (uint ticket; (ticket = take_ticket(tickets, first_ticket)) < ticket_count;) {
    const uint end = min((ticket + 1u) * params.batches_per_ticket, ao_params.point_count);
    for (uint point = ticket * params.batches_per_ticket; point < end; ++point) {
      make_rays_of(points + point, ao_params, rays);
      ao[point] = mean_transmittance(scene, params, rays, ao_params.rays);
    }
  }
}
