#include "passes/occlusion_pass.hpp"

#include "dapple/shared/ray.h"

namespace dapple {
namespace {

/// Work-items of a work-group of point packets on devices that run the items of a group in
/// parallel.
constexpr std::size_t kPacketGroup = 16;

}  // namespace

KernelName occlusion_kernel(Estimator estimator, Packets with) {
  const bool prefiltered = estimator != Estimator::exact;
  if (with == Packets::scalar)
    return {"occlusion_scalar", "scalar/occlusion_scalar", {prefiltered}};
  if (with == Packets::none) return {"occlusion", "occlusion/occlusion", {prefiltered}};
  return {"packet", "occlusion/packet", {prefiltered, with == Packets::point}};
}

KernelName ao_ray_kernel(const DeviceContext& context) {
  if (traces_scalar(context)) return {"ao_rays_scalar", "scalar/ao_scalar", {}};
  return {"ao_rays", "queue_kernels", {}};
}

KernelName point_ao_kernel(Estimator estimator) {
  return {"point_ao", "occlusion/point_ao", {estimator != Estimator::exact, true}};
}

// Several items only if those of a group run in parallel: packets take so much memory that
// Intel's CPU runtime refuses groups of 16.
std::size_t packet_group(const DeviceContext& context, Packets with) {
  return with == Packets::point && context.info().kind != "CPU" ? kPacketGroup : 1;
}

void generate_rays(DeviceContext& context, const KernelName& kernel, const std::string& label,
                   std::size_t rays, const std::vector<KernelArgument>& arguments) {
  if (traces_scalar(context)) {
    context.launch(kernel, label, rays, arguments, kRayGroup);
  } else {
    context.launch(kernel, label, ceil_div<std::size_t>(rays, DAPPLE_RAY_LANES), arguments,
                   kRayGeneratorGroup);
  }
}

void ao_ray_pass(DeviceContext& context, const Queues& queues, const AoParams& params) {
  const std::size_t rays = std::size_t{params.point_count} * params.rays;
  generate_rays(context, ao_ray_kernel(context), "ao rays", rays,
                {queues.points, queues.active, queues.rays, params});
}

OcclusionParams occlusion_params(const DeviceBuffers& scene, std::size_t points,
                                 std::size_t rays_per_point, float footprint) {
  OcclusionParams params{};
  params.scene = scene.params;
  params.ray_count = static_cast<uint>(points * rays_per_point);
  params.rays_per_point = static_cast<uint>(rays_per_point);
  params.footprint = footprint;
  return params;
}

void set_falloff(OcclusionParams& params, float distance, float power) {
  if (!(distance > 0 && power > 0)) return;
  params.inverse_distance = 1.0f / distance;
  params.falloff = power;
}

void gather_pass(DeviceContext& context, const Queues& queues, const Buffer& slots,
                 const Queues& gathered, uint ray_count, uint rays_per_point, uint first) {
  context.launch(kGatherRays, "bias report", ray_count,
                 {slots, ray_count, rays_per_point, first, queues.rays, queues.occlusions,
                  gathered.rays, gathered.occlusions},
                 kRayGroup);
}

std::size_t sums_per_point(std::size_t rays_per_point) {
  return ceil_div<std::size_t>(rays_per_point, DAPPLE_SUMMED_RAYS);
}

void sum_rays_pass(DeviceContext& context, const Queues& queues, const Buffer& sums,
                   std::size_t points, std::size_t rays_per_point) {
  context.launch(kSumRays, "sum rays", points * sums_per_point(rays_per_point),
                 {queues.rays, queues.occlusions, sums, static_cast<uint>(points),
                  static_cast<uint>(rays_per_point)},
                 kRayGroup);
}

void occlusion_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                    const std::string& label, Estimator estimator, const OcclusionParams& params,
                    RayOrder order) {
  occlusion_pass_with(choose_packets(estimator, params.rays_per_point, order, context), context,
                      queues, scene, label, estimator, params);
}

namespace {

/// Traces each ray in a work-item of its own, in an order in which neighbours are alike.
void trace_scalar(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                  const std::string& label, Estimator estimator, const OcclusionParams& params) {
  if (queues.order.memory())
    context.launch(kOrderRays, "order",
                   ceil_div<std::size_t>(params.ray_count, DAPPLE_ORDER_BATCH) * DAPPLE_ORDER_GROUP,
                   {queues.rays, queues.order, params.ray_count}, DAPPLE_ORDER_GROUP);
  context.launch(
      occlusion_kernel(estimator, Packets::scalar), label, params.ray_count,
      {scene.nodes, scene.blocks, scene.segments, scene.textured, scene.materials, scene.texels,
       scene.instances, queues.rays, queues.order, queues.occlusions, params},
      kRayGroup);
}

}  // namespace

void occlusion_pass_with(Packets with, DeviceContext& context, const Queues& queues,
                         const DeviceBuffers& scene, const std::string& label, Estimator estimator,
                         const OcclusionParams& params) {
  if (with == Packets::scalar)
    return trace_scalar(context, queues, scene, label, estimator, params);
  OcclusionParams launched = params;
  const KernelName kernel = occlusion_kernel(estimator, with);
  const std::vector<KernelArgument> arguments{
      scene.nodes,  scene.blocks,    scene.segments, scene.textured,    scene.materials,
      scene.texels, scene.instances, queues.rays,    queues.occlusions, launched};
  if (with == Packets::none) {
    context.launch(kernel, label, params.ray_count, arguments, kRayGroup);
  } else {
    const uint ticket_count = with == Packets::pixel
                                  ? split_pixel_rays(launched)
                                  : split_point_rays(context.info().kind == "CPU", launched);
    context.launch_with_tickets(kernel, label, ticket_count, arguments,
                                packet_group(context, with));
  }
}

bool has_point_ao_pass(const DeviceContext& context, Estimator estimator,
                       std::size_t rays_per_point) {
  return context.info().kind == "CPU" && rays_per_point <= DAPPLE_POINT_RAY_BATCH &&
         choose_packets(estimator, static_cast<uint>(rays_per_point), RayOrder::any, context) ==
             Packets::point;
}

void point_ao_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                   Estimator estimator, const AoParams& ao_params, const OcclusionParams& params) {
  OcclusionParams launched = params;
  const uint ticket_count = split_point_rays(true, launched);
  context.launch_with_tickets(
      point_ao_kernel(estimator), "ao", ticket_count,
      {scene.nodes, scene.blocks, scene.segments, scene.textured, scene.materials, scene.texels,
       scene.instances, queues.points, queues.rays, queues.occlusions, ao_params, launched},
      kPointGroup);
}

}  // namespace dapple
