// The occlusion passes: transmittance along queued rays, and the AO rays. In: the scene, surface
// points and rays. Out: rays, occlusions.
#pragma once

#include <string>

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"
#include "passes/ray_packets.hpp"

namespace dapple {

/// Work-items of a work-group of the kernels that generate rays; scalar ones have kRayGroup.
inline constexpr std::size_t kRayGeneratorGroup = 16;
/// Work-items of a work-group of point_ao.
inline constexpr std::size_t kPointGroup = 1;

KernelName occlusion_kernel(Estimator estimator, Packets with);
KernelName point_ao_kernel(Estimator estimator);
/// The kernel that generates AO rays on this device.
KernelName ao_ray_kernel(const DeviceContext& context);
inline const KernelName kGatherRays{"gather_rays", "queue_kernels", {}};
inline const KernelName kSumRays{"sum_rays", "queue_kernels", {}};
inline const KernelName kOrderRays{"order_rays", "scalar/order_rays", {}};
/// Work-items of a work-group of occlusion_kernel() with packets.
std::size_t packet_group(const DeviceContext& context, Packets with);

/// Launches a kernel that generates `rays` rays: ao_ray_kernel() or light_ray_kernel().
void generate_rays(DeviceContext& context, const KernelName& kernel, const std::string& label,
                   std::size_t rays, const std::vector<KernelArgument>& arguments);

/// Writes the AO rays of the active points to `rays`.
void ao_ray_pass(DeviceContext& context, const Queues& queues, const AoParams& params);

/// Copies the `rays` and `occlusions` of the points at these slots of the active list, `ray_count`
/// rays of them, to those of `gathered`, from ray `first` on.
void gather_pass(DeviceContext& context, const Queues& queues, const Buffer& slots,
                 const Queues& gathered, uint ray_count, uint rays_per_point, uint first);

/// RaySums of each point whose rays are summed.
std::size_t sums_per_point(std::size_t rays_per_point);

/// Adds up `rays` and `occlusions` of points: sums_per_point() RaySums of each to `sums`.
void sum_rays_pass(DeviceContext& context, const Queues& queues, const Buffer& sums,
                   std::size_t points, std::size_t rays_per_point);

/// Of `rays_per_point` rays of each of `points`, without a falloff. `footprint`: a scale, 0 or
/// more.
OcclusionParams occlusion_params(const DeviceBuffers& scene, std::size_t points,
                                 std::size_t rays_per_point, float footprint);

/// Surfaces occlude less the farther they are, nothing at `distance` metres; none where it, or
/// `power`, is 0.
void set_falloff(OcclusionParams& params, float distance, float power);

/// Writes the transmittance of each ray in `rays` to `occlusions`. CPUs trace point packets if
/// `params.rays_per_point` is large enough, else pixel packets; other devices trace single rays. A
/// device that was opened with given packets uses these.
void occlusion_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                    const std::string& label, Estimator estimator, const OcclusionParams& params,
                    RayOrder order = RayOrder::any);

/// The same with the given ray packets.
void occlusion_pass_with(Packets with, DeviceContext& context, const Queues& queues,
                         const DeviceBuffers& scene, const std::string& label, Estimator estimator,
                         const OcclusionParams& params);

/// Whether to use point_ao_pass(), which generates, traces and averages the AO rays of points in
/// one kernel without queues: on CPUs, with point packets, if one batch holds the rays of a point.
bool has_point_ao_pass(const DeviceContext& context, Estimator estimator,
                       std::size_t rays_per_point);

/// Writes the AO, [0,1], of `points` to `occlusions`; has_point_ao_pass() must be true.
void point_ao_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                   Estimator estimator, const AoParams& ao_params, const OcclusionParams& params);

}  // namespace dapple
