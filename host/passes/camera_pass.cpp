#include "passes/camera_pass.hpp"

namespace dapple {

KernelName camera_kernel(bool shared_origin) {
  return {"camera_hits", "camera/camera", {false, shared_origin}};
}

void camera_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                 const CameraParams& params) {
  const std::size_t rays =
      std::size_t{params.slice.pixel_count} * (params.slice.sample_count >> params.splitting_bits);
  CameraParams camera = params;
  camera.scene = scene.params;
  constexpr std::size_t kCameraRaysPerTicket =
      std::size_t{DAPPLE_ITEM_RAYS} * DAPPLE_ITEMS_PER_TICKET;
  context.launch_with_tickets(
      camera_kernel(params.orthographic == 0 && params.lens_radius == 0), "camera",
      ceil_div(rays, kCameraRaysPerTicket),
      {scene.nodes, scene.blocks, scene.segments, scene.textured, scene.materials, scene.texels,
       scene.instances, queues.work, queues.points, queues.sample_hits, camera},
      kCameraGroup);
}

void closest_hit_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                      std::size_t rays) {
  OcclusionParams params{};
  params.scene = scene.params;
  params.ray_count = static_cast<uint>(rays);
  context.launch(kClosestHit, "closest hit", rays,
                 {scene.nodes, scene.blocks, scene.segments, scene.textured, scene.materials,
                  scene.texels, scene.instances, queues.rays, queues.points, params});
}

std::uint32_t compact_pass(DeviceContext& context, const Queues& queues, std::size_t samples) {
  context.launch(kCompactHits, "compact", kScanItems,
                 {queues.sample_hits, queues.active, queues.active_count,
                  static_cast<uint>(hit_records(samples))},
                 kScanItems);
  std::uint32_t count = 0;
  context.read(queues.active_count, &count, sizeof count);
  return count;
}

}  // namespace dapple
