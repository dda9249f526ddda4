// The occlusion passes: transmittance along queued rays, and the AO rays. In: the scene, surface
// points and rays. Out: rays, occlusions.
#pragma once

#include <string>

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"
#include "passes/ray_packets.hpp"

namespace dapple {

/// Work-items of a work-group of the kernels that generate rays.
inline constexpr std::size_t kRayGeneratorGroup = 16;
/// Rays that one work-item of these generates; DAPPLE_RAY_LANES in
/// kernels/occlusion/point_rays.clh.
inline constexpr std::size_t kRayLanes = 16;
/// Work-items of a work-group of point_ao.
inline constexpr std::size_t kPointGroup = 1;

KernelName occlusion_kernel(Estimator estimator, Packets with);
KernelName point_ao_kernel(Estimator estimator);
inline const KernelName kAoRays{"ao_rays", "queue_kernels", {}};
/// Work-items of a work-group of occlusion_kernel() with packets.
std::size_t packet_group(const DeviceContext& context, Packets with);

/// AO rays of the active points into `rays`.
void ao_ray_pass(DeviceContext& context, const Queues& queues, const AoParams& params);

/// Transmittance of each ray in `rays` into `occlusions`. On CPUs in point packets, where
/// `params.rays_per_point` is large enough for that to pay, else in pixel packets; on other devices
/// as single rays, unless the device was opened with other packets.
void occlusion_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                    const std::string& label, Estimator estimator, const OcclusionParams& params,
                    RayOrder order = RayOrder::any);

/// The same with the given ray packets.
void occlusion_pass_with(Packets with, DeviceContext& context, const Queues& queues,
                         const DeviceBuffers& scene, const std::string& label, Estimator estimator,
                         const OcclusionParams& params);

/// Whether point_ao_pass() is to be used: AO rays of points are generated, traced and averaged by
/// one kernel without queues. On CPUs, with point packets, where one batch holds a point's rays.
bool has_point_ao_pass(const DeviceContext& context, Estimator estimator,
                       std::size_t rays_per_point);

/// AO in [0,1] of the points in `points` into `occlusions`, where has_point_ao_pass().
void point_ao_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                   Estimator estimator, const AoParams& ao_params, const OcclusionParams& params);

}  // namespace dapple
