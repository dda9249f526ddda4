/* Ambient occlusion at points with few rays, in one kernel: the work-item that takes a point generates
   its rays, traces them as packets and averages them, without a queue between the passes. In: the
   scene and the points. Out: the mean transmittance of each point. A ray has the same transmittance
   as in packet.cl. */
#include "occlusion/ao_rays.clh"
#include "occlusion/packet.clh"
#include "occlusion/packet_order.clh"
#include "vectors/tickets.clh"

/* Transmittances are added in units of 2^-40; the sum is exact, so it does not depend on the order. */
#define DAPPLE_AO_STEPS 1099511627776.0f

/* Sum of the transmittances of the packet's first `count` rays, in units of 2^-40. */
inline long sum_transmittances(OcclusionParams params, const Packet* packet, uint count) {
  long8 sums = (long8)(0);
  for (uint i = 0; i < count; i += 8u) {
    const int8 counts = (int8)(0, 1, 2, 3, 4, 5, 6, 7) < (int)(count - i);
    const float8 seen = counts ? packet_transmittance(params, packet, i) : (float8)(0.0f);
    sums += convert_long8(seen * DAPPLE_AO_STEPS);
  }
  const long4 four = sums.lo + sums.hi;
  return four.x + four.y + four.z + four.w;
}

/* Number of rays that the surface itself hides: tracing finds a transmittance of 1 for them. */
inline uint count_below(__global const Ray* rays, uint count) {
  uint below = 0;
  for (uint i = 0; i < count; ++i) below += rays[i].weight == 0.0f ? 1u : 0u;
  return below;
}

/* Mean transmittance, [0,1], of the `count` rays of a point, `below` of which are below the surface. */
inline float mean_transmittance(Scene scene, OcclusionParams params, __global const Ray* rays,
                                uint count, uint below) {
  ushort order[DAPPLE_RAY_BATCH];
  const uint traced = order_batch(rays, count, order);
  long sum = ((long)(count - traced) - (long)below) * (long)DAPPLE_AO_STEPS;
  for (uint i = 0; i < traced; i += DAPPLE_PACKET_RAYS) {
    const uint together = min(traced - i, DAPPLE_PACKET_RAYS);
    Packet packet;
    traverse_rays(scene, params, rays, order + i, together, &packet);
    sum += sum_transmittances(params, &packet, together);
  }
  return (float)sum / (DAPPLE_AO_STEPS * (float)count);
}

/* Generates all params.rays rays of the point. */
inline void make_rays_of(__global const SurfacePoint* point, AoParams params,
                         __global Ray* rays) {
  for (uint first = 0; first < params.rays; first += DAPPLE_RAY_LANES) {
    PointRays chosen;
    load_point(point, params.rays, first, params.rays, &chosen);
    make_ao_rays(&chosen, params, rays + first);
  }
}

/* A work-group is one item; `scratch` has room for the rays of one point for each work-group. A ticket
   is params.batches_per_ticket points. */
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
      const uint below = ao_params.shaded ? count_below(rays, ao_params.rays) : 0u;
      ao[point] = mean_transmittance(scene, params, rays, ao_params.rays, below);
    }
  }
}
