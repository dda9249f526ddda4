// The light pass generates shadow rays. In: surface points and the scene's lights. Out: rays for
// occlusion_pass().
#pragma once

#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple {

inline const KernelName kLightRays{"light_rays", "queue_kernels", {}};

/// Writes rays from the active points to one light to `rays`.
void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params);

}  // namespace dapple
