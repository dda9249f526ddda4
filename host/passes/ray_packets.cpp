#include "passes/ray_packets.hpp"

#include <algorithm>

#include "dapple/shared/ray.h"
#include "device/platform_names.hpp"
#include "passes/queues.hpp"

namespace dapple {
namespace {

/// Minimum number of rays per point for packets: experiment 301.
constexpr uint kMinPacketRays = 4;

/// Minimum number of rays per point for point packets: experiment 302.
constexpr uint kMinPointPacketRays = 16;

/// The same for exact rays, which spend their time on triangles: with fewer rays full packets over
/// several points are faster (experiment 303).
constexpr uint kMinExactPointPacketRays = 32;

/// Quarters of the pixel rays that are in large batches. The others are in small batches, so that
/// threads finish at about the same time: experiment 304.
constexpr uint kLargeBatchQuarters = 3;

/// Maximum number of rays in a ticket of points on a CPU, unless a single point has more. With one
/// point per ticket all threads would read the same nodes (experiment 601).
constexpr uint kRaysPerTicket = 256;

/// Whether scalar kernels are faster. Mesa's driver for CPUs compiles kernels of wide vectors for
/// tens of minutes (experiment 753).
bool suits_scalar(const DeviceInfo& device) {
  return device.kind != "CPU" || device.platform == kMesaPlatform;
}

}  // namespace

bool traces_scalar(const DeviceContext& context) {
  const Packets packets = context.packets();
  return packets == Packets::scalar ||
         (packets == Packets::automatic && suits_scalar(context.info()));
}

Packets choose_packets(Estimator estimator, uint rays_per_point, RayOrder order,
                       const DeviceContext& context) {
  if (context.packets() != Packets::automatic) return context.packets();
  if (traces_scalar(context)) return Packets::scalar;
  const uint min_of_point =
      estimator == Estimator::exact ? kMinExactPointPacketRays : kMinPointPacketRays;
  if (rays_per_point >= min_of_point) return Packets::point;
  return rays_per_point >= kMinPacketRays || order == RayOrder::by_pixel ? Packets::pixel
                                                                         : Packets::none;
}

Packets packets_in_picture(const DeviceContext& context, Estimator estimator, int rays) {
  return choose_packets(estimator, static_cast<uint>(rays), RayOrder::by_pixel, context);
}

uint split_pixel_rays(OcclusionParams& params) {
  params.large_batches = params.ray_count / DAPPLE_PIXEL_RAY_BATCH * kLargeBatchQuarters / 4;
  const uint rest = params.ray_count - params.large_batches * DAPPLE_PIXEL_RAY_BATCH;
  return params.large_batches + ceil_div<uint>(rest, DAPPLE_SMALL_RAY_BATCH);
}

uint split_point_rays(bool on_cpu, OcclusionParams& params) {
  const uint batches = ceil_div<uint>(params.rays_per_point, DAPPLE_POINT_RAY_BATCH);
  params.batches_per_ticket = on_cpu ? std::max(1u, kRaysPerTicket / params.rays_per_point) : 1u;
  return ceil_div<uint>(params.ray_count / params.rays_per_point * batches,
                        params.batches_per_ticket);
}

}  // namespace dapple
