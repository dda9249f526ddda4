#include "passes/light_pass.hpp"

#include "passes/occlusion_pass.hpp"

namespace dapple {

KernelName light_ray_kernel(const DeviceContext& context) {
  if (traces_scalar(context)) return {"light_rays_scalar", "lights/light_scalar", {}};
  return {"light_rays", "queue_kernels", {}};
}

void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params) {
  const std::size_t rays = std::size_t{params.point_count} * params.rays;
  generate_rays(context, light_ray_kernel(context), "light rays", rays,
                {queues.points, queues.active, scene.lights, scene.emitters, scene.environments,
                 queues.rays, params});
}

}  // namespace dapple
