// Launches of the passes: which kernel, which ray packets, how many work-items. In: queues and
// parameters; out: what kernels write. Queues between small kernels: Laine, Karras and Aila,
// "Megakernels Considered Harmful", 2013.
#include "passes/passes.hpp"

#include <algorithm>

#include "dapple/shared/ray.h"

namespace dapple {
namespace {

/// Work-items of the one group that compacts; DAPPLE_SCAN_ITEMS in kernels/film/compact.cl.
constexpr std::size_t kScanItems = 256;

/// Smallest number of rays of a point for which packets pay: experiment 301.
constexpr uint kMinPacketRays = 4;

/// Smallest number of rays of a point for which a packet of their own, with a shared origin, pays:
/// experiment 302.
constexpr uint kMinPointPacketRays = 16;

/// The same for exact rays, which spend their time on triangles: with fewer rays full packets over
/// several points are faster (experiment 303).
constexpr uint kMinExactPointPacketRays = 32;

/// Quarters of the pixel rays that go in large batches. The rest goes in small ones, so that
/// threads end at about the same time: experiment 304.
constexpr uint kLargeBatchQuarters = 3;

/// Most rays of points that one ticket stands for on a CPU, unless a single point has more. With a
/// ticket a point all threads would read the same nodes (experiment 601).
constexpr uint kRaysPerTicket = 256;

/// Work-items a work-group: few where an item does much work.
constexpr std::size_t kRayGroup = 64, kPacketGroup = 16, kCameraGroup = 1, kPointGroup = 1;

/// Rays that one work-item of the ray-generating kernels makes; DAPPLE_RAY_LANES in
/// kernels/occlusion/point_rays.clh.
constexpr std::size_t kRayLanes = 16;

/// `count` / `size`, rounded up.
template <class T>
T ceil_div(T count, T size) {
  return (count + size - 1) / size;
}

std::size_t hit_records(std::size_t samples) {
  return ceil_div<std::size_t>(samples, DAPPLE_HIT_BITS);
}

/// Independent of the number of rays, so that a crop reproduces the full picture bit for bit (the
/// kernels round differently).
Packets choose_packets(Estimator estimator, uint rays_per_point, RayOrder order,
                       const DeviceContext& context) {
  if (context.packets() != Packets::automatic) return context.packets();
  if (context.info().kind != "CPU") return Packets::none;
  const uint min_of_point =
      estimator == Estimator::exact ? kMinExactPointPacketRays : kMinPointPacketRays;
  if (rays_per_point >= min_of_point) return Packets::point;
  return rays_per_point >= kMinPacketRays || order == RayOrder::by_pixel ? Packets::pixel
                                                                         : Packets::none;
}

/// Cuts a queue of pixel rays into batches and returns their number. Independent of the number of
/// threads, since batches decide how visits are counted.
uint split_pixel_rays(OcclusionParams& params) {
  params.large_batches = params.ray_count / DAPPLE_PIXEL_RAY_BATCH * kLargeBatchQuarters / 4;
  const uint rest = params.ray_count - params.large_batches * DAPPLE_PIXEL_RAY_BATCH;
  return params.large_batches + ceil_div<uint>(rest, DAPPLE_SMALL_RAY_BATCH);
}

/// Cuts a queue of point rays into batches, combines batches into tickets, and returns the number
/// of tickets.
uint split_point_rays(bool on_cpu, OcclusionParams& params) {
  const uint chunks = ceil_div<uint>(params.rays_per_point, DAPPLE_POINT_RAY_BATCH);
  params.batches_per_ticket = on_cpu ? std::max(1u, kRaysPerTicket / params.rays_per_point) : 1u;
  return ceil_div<uint>(params.ray_count / params.rays_per_point * chunks,
                        params.batches_per_ticket);
}

KernelName occlusion_kernel(Estimator estimator, Packets with) {
  const bool prefiltered = estimator != Estimator::exact;
  if (with == Packets::none) return {"occlusion", "occlusion/occlusion", {prefiltered}};
  return {"packet", "occlusion/packet", {prefiltered, with == Packets::point}};
}

KernelName point_ao_kernel(Estimator estimator) {
  return {"point_ao", "occlusion/point_ao", {estimator != Estimator::exact, true}};
}

KernelName camera_kernel(bool orthographic) {
  return {"camera_hits", "camera/camera", {false, !orthographic}};
}

/// Several only where items of a group run side by side: packets take so much memory that Intel's
/// CPU runtime refuses groups of 16.
std::size_t packet_group(const DeviceContext& context, Packets with) {
  return with == Packets::point && context.info().kind != "CPU" ? kPacketGroup : 1;
}

const KernelName kClosestHit{"closest_hit", "camera/closest_hit", {}};
const KernelName kCompactHits{"compact_hits", "queue_kernels", {}};
const KernelName kAoRays{"ao_rays", "queue_kernels", {}};
const KernelName kLightRays{"light_rays", "queue_kernels", {}};
const KernelName kResolveSurface{"resolve_surface", "queue_kernels", {}};
const KernelName kResolveAo{"resolve_ao", "queue_kernels", {}};
const KernelName kResolveLight{"resolve_light", "queue_kernels", {}};
const KernelName kResolveDome{"resolve_dome", "lights/dome", {}};

}  // namespace

std::size_t Queues::bytes() const {
  return work.bytes() + rays.bytes() + points.bytes() + sample_hits.bytes() + active.bytes() +
         active_count.bytes() + occlusions.bytes();
}

Queues make_queues(DeviceContext& context, std::size_t samples, std::size_t rays_per_sample) {
  Queues queues;
  queues.rays = context.allocate(samples * rays_per_sample * sizeof(Ray));
  queues.points = context.allocate(samples * sizeof(SurfacePoint));
  queues.sample_hits = context.allocate(hit_records(samples) * sizeof(SampleHits));
  queues.active = context.allocate(samples * sizeof(uint));
  queues.active_count = context.allocate(sizeof(uint));
  queues.occlusions = context.allocate(samples * rays_per_sample * sizeof(Occlusion));
  return queues;
}

Queues make_point_queues(DeviceContext& context, std::size_t points, std::size_t rays_per_point) {
  const std::size_t at_work = context.groups_with_tickets(points);
  Queues queues;
  queues.rays = context.allocate(at_work * rays_per_point * sizeof(Ray));
  queues.occlusions = context.allocate(points * sizeof(float));
  return queues;
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
      camera_kernel(params.orthographic != 0), "camera", ceil_div(rays, kCameraRaysPerTicket),
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

void ao_ray_pass(DeviceContext& context, const Queues& queues, const AoParams& params) {
  const std::size_t rays = std::size_t{params.point_count} * params.rays;
  context.launch(kAoRays, "ao rays", ceil_div(rays, kRayLanes),
                 {queues.points, queues.active, queues.rays, params}, kPacketGroup);
}

void light_ray_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                    const LightParams& params) {
  const std::size_t rays = std::size_t{params.point_count} * params.rays;
  context.launch(kLightRays, "light rays", ceil_div(rays, kRayLanes),
                 {queues.points, queues.active, scene.lights, scene.emitters, scene.environments,
                  queues.rays, params},
                 kPacketGroup);
}

void occlusion_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                    const std::string& label, Estimator estimator, const OcclusionParams& params,
                    RayOrder order) {
  occlusion_pass_with(choose_packets(estimator, params.rays_per_point, order, context), context,
                      queues, scene, label, estimator, params);
}

void occlusion_pass_with(Packets with, DeviceContext& context, const Queues& queues,
                         const DeviceBuffers& scene, const std::string& label, Estimator estimator,
                         const OcclusionParams& params) {
  OcclusionParams launched = params;
  const KernelName kernel = occlusion_kernel(estimator, with);
  const std::vector<KernelArgument> arguments{
      scene.nodes,  scene.blocks,    scene.segments, scene.textured,    scene.materials,
      scene.texels, scene.instances, queues.rays,    queues.occlusions, launched};
  if (with == Packets::none) {
    context.launch(kernel, label, params.ray_count, arguments, kRayGroup);
  } else {
    const uint ticket_count = with == Packets::pixel
                                  ? split_pixel_rays(launched)
                                  : split_point_rays(context.info().kind == "CPU", launched);
    context.launch_with_tickets(kernel, label, ticket_count, arguments,
                                packet_group(context, with));
  }
}

bool at_once(const DeviceContext& context, Estimator estimator, std::size_t rays_per_point) {
  return context.info().kind == "CPU" && rays_per_point <= DAPPLE_POINT_RAY_BATCH &&
         choose_packets(estimator, static_cast<uint>(rays_per_point), RayOrder::any, context) ==
             Packets::point;
}

void point_ao_pass(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                   Estimator estimator, const AoParams& ao_params, const OcclusionParams& params) {
  OcclusionParams launched = params;
  const uint ticket_count = split_point_rays(true, launched);
  context.launch_with_tickets(
      point_ao_kernel(estimator), "ao", ticket_count,
      {scene.nodes, scene.blocks, scene.segments, scene.textured, scene.materials, scene.texels,
       scene.instances, queues.points, queues.rays, queues.occlusions, ao_params, launched},
      kPointGroup);
}

void resolve_surface_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                          const ResolveParams& params) {
  context.launch(kResolveSurface, "resolve", params.slice.pixel_count,
                 {queues.work, queues.points, queues.sample_hits, film.sums, params});
}

void resolve_ao_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                     const ResolveParams& params) {
  context.launch(kResolveAo, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, film.sums,
                  film.squares, params});
}

void resolve_light_pass(DeviceContext& context, const Queues& queues, const FilmBuffers& film,
                        const ResolveParams& params) {
  context.launch(kResolveLight, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, film.sums,
                  film.squares, params});
}

std::vector<KernelShape> every_kernel(const DeviceContext& context) {
  std::vector<KernelShape> kernels{
      {kClosestHit, kRayGroup},     {kCompactHits, kScanItems}, {kAoRays, kPacketGroup},
      {kLightRays, kPacketGroup},   {kResolveDome, kRayGroup},  {kResolveAo, kRayGroup},
      {kResolveSurface, kRayGroup}, {kResolveLight, kRayGroup},
  };
  for (const bool orthographic : {false, true})
    kernels.push_back({camera_kernel(orthographic), kCameraGroup});
  for (const Estimator estimator : {Estimator::exact, Estimator::prefiltered}) {
    kernels.push_back({occlusion_kernel(estimator, Packets::none), kRayGroup});
    kernels.push_back({point_ao_kernel(estimator), kPointGroup});
    for (const Packets with : {Packets::pixel, Packets::point})
      kernels.push_back({occlusion_kernel(estimator, with), packet_group(context, with)});
  }
  return kernels;
}

Packets packets_in_picture(const DeviceContext& context, Estimator estimator, int rays) {
  return choose_packets(estimator, static_cast<uint>(rays), RayOrder::by_pixel, context);
}

void resolve_dome_pass(DeviceContext& context, const DeviceBuffers& scene, const Queues& queues,
                       const FilmBuffers& film, const ResolveParams& params, uint light) {
  context.launch(kResolveDome, "resolve", params.slice.pixel_count,
                 {queues.work, queues.sample_hits, queues.rays, queues.occlusions, scene.lights,
                  scene.environments, film.sums, film.squares, params, light});
}

std::vector<KernelName> picture_kernels(const DeviceContext& context, const RenderOptions& options,
                                        const Camera& camera, const std::vector<Light>& lights) {
  std::vector<KernelName> kernels{camera_kernel(camera.kind == Camera::Kind::orthographic),
                                  kCompactHits, kResolveSurface};
  const auto add_occlusion = [&](int rays) {
    kernels.push_back(
        occlusion_kernel(options.estimator, packets_in_picture(context, options.estimator, rays)));
  };
  if (options.ao) {
    add_occlusion(options.ao_rays);
    kernels.insert(kernels.end(), {kAoRays, kResolveAo});
  }
  if (options.light) {
    add_occlusion(options.light_rays);
    kernels.push_back(kLightRays);
    for (const Light& light : lights)
      kernels.push_back(light.kind == LightKind::dome ? kResolveDome : kResolveLight);
  }
  return kernels;
}

}  // namespace dapple
