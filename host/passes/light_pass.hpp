// The light pass generates shadow rays. In: surface points and the scene's lights. Out: rays for
// occlusion_pass().
#pragma once

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

/// The kernel that generates rays to lights on this device.
KernelName light_ray_kernel(const DeviceContext& context);

/// Writes rays from the active points to one light to `rays`.
void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params);

}  // namespace dapple
