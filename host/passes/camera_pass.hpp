// The camera pass: first surfaces of camera rays, and of the rays of queries. In: the scene and
// pixels or rays. Out: surface points, and the indices of those that exist.
#pragma once

#include <cstdint>

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

/// Work-items of a work-group of camera_hits; camera_hits_scalar has kRayGroup.
inline constexpr std::size_t kCameraGroup = 1;

/// The kernel of the camera pass on this device. `shared_origin`: is_pinhole() of the camera.
KernelName camera_kernel(const DeviceContext& context, bool shared_origin);
inline const KernelName kClosestHit{"closest_hit", "camera/closest_hit", {}};
inline const KernelName kCountHits{"count_hits", "queue_kernels", {}};
inline const KernelName kCompactHits{"compact_hits", "queue_kernels", {}};

/// Writes the first surfaces of the slice's camera rays to `points` and `sample_hits`.
void camera_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                 const CameraParams& params);

/// Writes the first surface of each ray in `rays` to `points`.
void closest_hit_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                      std::size_t rays);

/// Fills `active` and numbers the hits in `sample_hits`; returns how many samples hit. Waits for
/// the device.
std::uint32_t compact_pass(DeviceContext& context, const Queues& queues, std::size_t samples);

}  // namespace dapple
