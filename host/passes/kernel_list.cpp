#include "passes/kernel_list.hpp"

#include "passes/back_pass.hpp"
#include "passes/camera_pass.hpp"
#include "passes/light_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/ray_packets.hpp"
#include "passes/resolve_pass.hpp"
#include "passes/shading_pass.hpp"

namespace dapple {

std::vector<KernelShape> every_kernel(const DeviceContext& context) {
  std::vector<KernelShape> kernels{
      {kClosestHit, kRayGroup},
      {kCompactHits, DAPPLE_SCAN_ITEMS},
      {kResolveDome, kRayGroup},
      {kResolveAo, kRayGroup},
      {kResolveLight, kRayGroup},
      {kFlipPoints, kRayGroup},
      {kResolveSurface, kRayGroup},
      {kGatherRays, kRayGroup},
      {kSumRays, kRayGroup},
      {kCountBacks, kRayGroup},
      {shading_kernel(context), kRayGroup},
  };
  const bool scalar = traces_scalar(context);
  const std::size_t generators = scalar ? kRayGroup : kRayGeneratorGroup;
  kernels.push_back({ao_ray_kernel(context), generators});
  kernels.push_back({light_ray_kernel(context), generators});
  if (scalar) {
    kernels.push_back({kCountHits, DAPPLE_SCAN_ITEMS});
    kernels.push_back({kOrderRays, DAPPLE_ORDER_GROUP});
    kernels.push_back({camera_kernel(context, true), kRayGroup});
    for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered})
      kernels.push_back({occlusion_kernel(estimator, Packets::scalar), kRayGroup});
    return kernels;
  }
  for (const bool shared_origin : {true, false})
    kernels.push_back({camera_kernel(context, shared_origin), kCameraGroup});
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    kernels.push_back({occlusion_kernel(estimator, Packets::none), kRayGroup});
    kernels.push_back({point_ao_kernel(estimator), kPointGroup});
    for (const Packets with : {Packets::pixel, Packets::point})
      kernels.push_back({occlusion_kernel(estimator, with), packet_group(context, with)});
  }
  return kernels;
}

std::vector<KernelName> picture_kernels(const DeviceContext& context, const RenderOptions& options,
                                        const Camera& camera, const std::vector<Light>& lights,
                                        bool shaded) {
  std::vector<KernelName> kernels{camera_kernel(context, is_pinhole(camera)), kCompactHits,
                                  kResolveSurface};
  if (traces_scalar(context)) kernels.insert(kernels.end(), {kCountHits, kOrderRays});
  if (shaded) kernels.push_back(shading_kernel(context));
  if (options.back) kernels.insert(kernels.end(), {kFlipPoints, kCountBacks});
  const auto add_occlusion = [&](int rays) {
    kernels.push_back(
        occlusion_kernel(options.estimator, packets_in_picture(context, options.estimator, rays)));
    if (!measures_bias(options)) return;
    kernels.push_back(
        occlusion_kernel(Estimator::exact, packets_in_picture(context, Estimator::exact, rays)));
    kernels.push_back(kGatherRays);
  };
  if (options.ao) {
    add_occlusion(options.ao_rays);
    kernels.insert(kernels.end(), {ao_ray_kernel(context), kResolveAo});
  }
  if (options.light) {
    add_occlusion(options.light_rays);
    kernels.push_back(light_ray_kernel(context));
    for (const Light& light : lights)
      kernels.push_back(light.kind == LightKind::dome ? kResolveDome : kResolveLight);
  }
  return kernels;
}

std::vector<KernelName> point_kernels(const DeviceContext& context, const PointQuery& query) {
  std::vector<KernelName> kernels;
  const auto rays = static_cast<uint>(query.rays);
  const auto add = [&](Estimator by) {
    const bool by_points = query.ao && has_point_ao_pass(context, by, rays);
    if (by_points) kernels.push_back(point_ao_kernel(by));
    if ((query.ao && !by_points) || query.bent || query.light || query.given_rays)
      kernels.push_back(occlusion_kernel(by, choose_packets(by, rays, RayOrder::any, context)));
    if ((query.ao && !by_points) || query.bent)
      kernels.insert(kernels.end(), {ao_ray_kernel(context), kSumRays});
  };
  add(query.estimator);
  if (query.measures_bias && query.estimator != Estimator::exact) add(Estimator::exact);
  if (query.light) kernels.insert(kernels.end(), {light_ray_kernel(context), kSumRays});
  if (traces_scalar(context)) kernels.push_back(kOrderRays);
  return kernels;
}

}  // namespace dapple
