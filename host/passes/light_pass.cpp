#include "passes/light_pass.hpp"

#include "passes/occlusion_pass.hpp"

namespace dapple {

void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params) {
  const std::size_t rays = std::size_t{params.point_count} * params.rays;
  context.launch(kLightRays, "light rays", ceil_div(rays, kRayLanes),
                 {queues.points, queues.active, scene.lights, scene.emitters, scene.environments,
                  queues.rays, params},
                 kRayGeneratorGroup);
}

}  // namespace dapple
