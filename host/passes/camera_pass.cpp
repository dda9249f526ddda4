#include "passes/camera_pass.hpp"

#include <algorithm>

#include "passes/ray_packets.hpp"

namespace dapple {

KernelName camera_kernel(const DeviceContext& context, bool shared_origin) {
  if (traces_scalar(context)) return {"camera_hits_scalar", "scalar/camera_scalar", {}};
  return {"camera_hits", "camera/camera", {false, shared_origin}};
}

void camera_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                 const CameraParams& params) {
  const std::size_t rays =
      std::size_t{params.slice.pixel_count} * (params.slice.sample_count >> params.splitting_bits);
  CameraParams camera = params;
  camera.scene = scene.params;
  const KernelName kernel =
      camera_kernel(context, camera.orthographic == 0 && camera.lens_radius == 0);
  const std::vector<KernelArgument> arguments{scene.nodes,        scene.blocks,    scene.segments,
                                              scene.textured,     scene.materials, scene.texels,
                                              scene.instances,    queues.work,     queues.points,
                                              queues.sample_hits, camera};
  if (traces_scalar(context)) {
    context.launch(kernel, "camera", rays, arguments, kRayGroup);
    return;
  }
  constexpr std::size_t kCameraRaysPerTicket =
      std::size_t{DAPPLE_ITEM_RAYS} * DAPPLE_ITEMS_PER_TICKET;
  context.launch_with_tickets(kernel, "camera", ceil_div(rays, kCameraRaysPerTicket), arguments,
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
  const std::size_t records = hit_records(samples);
  const bool parallel = traces_scalar(context);
  const std::size_t groups =
      parallel ? std::max<std::size_t>(ceil_div<std::size_t>(records, DAPPLE_SCAN_ITEMS), 1) : 1;
  const auto record_count = static_cast<uint>(records);
  const auto of_group = parallel ? DAPPLE_SCAN_ITEMS : record_count;
  if (parallel)
    context.launch(kCountHits, "compact", groups * DAPPLE_SCAN_ITEMS,
                   {queues.sample_hits, queues.group_hits, record_count, of_group},
                   DAPPLE_SCAN_ITEMS);
  context.launch(kCompactHits, "compact", groups * DAPPLE_SCAN_ITEMS,
                 {queues.sample_hits, queues.active, queues.active_count, queues.group_hits,
                  record_count, of_group},
                 DAPPLE_SCAN_ITEMS);
  std::uint32_t count = 0;
  context.read(queues.active_count, &count, sizeof count);
  return count;
}

}  // namespace dapple
