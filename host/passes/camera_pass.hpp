// The camera pass: first surfaces of camera rays, and of the rays of queries. In: the scene and
// pixels or rays. Out: surface points, and the indices of those that exist.
#pragma once

#include <cstdint>

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

/// Work-items of a work-group of camera_hits.
inline constexpr std::size_t kCameraGroup = 1;
/// Work-items of the one work-group that compacts; DAPPLE_SCAN_ITEMS in kernels/film/compact.cl.
inline constexpr std::size_t kScanItems = 256;

KernelName camera_kernel(bool shared_origin);
inline const KernelName kClosestHit{"closest_hit", "camera/closest_hit", {}};
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
