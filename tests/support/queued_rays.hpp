// Traces rays in a queue, as pictures and bakers do. In: rays; out: what each of them finds.
#pragma once

#include <limits>
#include <vector>

#include "device/context.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "passes/ray_packets.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple::scene_test {

/// What the rays find at a footprint of 1. Each `rays_per_point` consecutive rays start at one
/// point. The transmittance of a ray that was not traced is NaN.
inline std::vector<Occlusion> trace_queue(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                                          Estimator estimator, std::size_t rays_per_point,
                                          RayOrder order) {
  DeviceContext& context = device().context();
  const Queues queues = make_queues(context, rays.size(), 1);
  context.write(queues.rays, rays.data(), rays.size() * sizeof(Ray));
  std::vector<Occlusion> found(rays.size(), {std::numeric_limits<float>::quiet_NaN(), 0});
  context.write(queues.occlusions, found.data(), found.size() * sizeof(Occlusion));
  OcclusionParams params{};
  params.scene = scene.uploaded.buffers->params;
  params.ray_count = static_cast<uint>(rays.size());
  params.rays_per_point = static_cast<uint>(rays_per_point);
  params.footprint = 1;
  occlusion_pass(context, queues, *scene.uploaded.buffers, "test", estimator, params, order);
  context.read(queues.occlusions, found.data(), found.size() * sizeof(Occlusion));
  return found;
}

}  // namespace dapple::scene_test
