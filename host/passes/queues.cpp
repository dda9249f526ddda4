#include "passes/queues.hpp"

#include <algorithm>

#include "dapple/shared/pass_params.h"
#include "dapple/shared/ray.h"
#include "passes/ray_packets.hpp"

namespace dapple {

std::size_t query_points(const DeviceContext& context, std::size_t rays_per_point,
                         std::size_t count) {
  const std::size_t rays = traces_scalar(context) ? 4 * kQueryRays : kQueryRays;
  return std::min(std::max<std::size_t>(1, rays / rays_per_point), count);
}

std::size_t hit_records(std::size_t samples) {
  return ceil_div<std::size_t>(samples, DAPPLE_HIT_BITS);
}

std::size_t Queues::bytes() const {
  return work.bytes() + rays.bytes() + points.bytes() + sample_hits.bytes() + active.bytes() +
         active_count.bytes() + group_hits.bytes() + occlusions.bytes() + albedo.bytes() +
         order.bytes();
}

Queues make_queues(DeviceContext& context, std::size_t samples, std::size_t rays_per_sample) {
  Queues queues;
  queues.rays = context.allocate(samples * rays_per_sample * sizeof(Ray));
  queues.points = context.allocate(samples * sizeof(SurfacePoint));
  queues.sample_hits = context.allocate(hit_records(samples) * sizeof(SampleHits));
  queues.active = context.allocate(samples * sizeof(uint));
  queues.active_count = context.allocate(sizeof(uint));
  queues.group_hits = context.allocate(
      ceil_div<std::size_t>(hit_records(samples), DAPPLE_SCAN_ITEMS) * sizeof(uint));
  queues.occlusions = context.allocate(samples * rays_per_sample * sizeof(Occlusion));
  queues.albedo = context.allocate(0);
  if (traces_scalar(context))
    queues.order = context.allocate(samples * rays_per_sample * sizeof(uint));
  return queues;
}

Queues make_point_queues(DeviceContext& context, std::size_t points, std::size_t rays_per_point) {
  const std::size_t at_work = context.groups_with_tickets(points);
  Queues queues;
  queues.rays = context.allocate(at_work * rays_per_point * sizeof(Ray));
  queues.occlusions = context.allocate(points * sizeof(float));
  return queues;
}

}  // namespace dapple
