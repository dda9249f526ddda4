// Queries with rays of the caller: trace() and closest_hits().
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "device/context.hpp"
#include "device/upload/scene_upload.hpp"
#include "passes/camera_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"

namespace dapple {
namespace {

/// Throws Error usage unless every rays_per_point consecutive rays have one origin and one light.
void check_points(std::span<const Ray> rays, std::size_t rays_per_point) {
  if (rays_per_point < 1 || rays.size() % rays_per_point != 0) {
    throw Error(ErrorKind::usage, fmt::format("trace: {} rays are no whole number of points of {}",
                                              rays.size(), rays_per_point));
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!std::all_of(rays[i].origin, rays[i].origin + 3, [](float x) { return std::isfinite(x); }))
      throw Error(ErrorKind::usage, fmt::format("trace: ray {} has no finite origin", i));
    const Ray& first = rays[i - i % rays_per_point];
    if (std::equal(first.origin, first.origin + 3, rays[i].origin) && first.light == rays[i].light)
      continue;
    throw Error(ErrorKind::usage,
                fmt::format("trace: ray {} starts elsewhere or is aimed at another light than the "
                            "first of its point",
                            i));
  }
}

}  // namespace

std::vector<Occlusion> trace(const Device& device, const DeviceScene& scene,
                             std::span<const Ray> rays, Estimator estimator, float footprint,
                             std::size_t rays_per_point) {
  check_points(rays, rays_per_point);
  if (!(footprint >= 0 && footprint <= 1e6f))
    throw Error(ErrorKind::usage,
                fmt::format("trace: footprint is {:g}; it must be from 0 to 1e+06", footprint));
  check_uploaded(scene);
  DeviceContext& context = device.context();
  // Rays of a point packet share a light; with several lights each ray is traced singly.
  const bool one_light = std::all_of(rays.begin(), rays.end(),
                                     [&](const Ray& ray) { return ray.light == rays[0].light; });
  if (!one_light) rays_per_point = 1;
  const bool single = !one_light && context.packets() == Packets::pixel;
  const std::size_t slice = std::max<std::size_t>(1, kQueryRays / rays_per_point) * rays_per_point;
  const Queues queues = make_queues(context, std::min(slice, rays.size()), 1);
  std::vector<Occlusion> results(rays.size());
  for (std::size_t begin = 0; begin < rays.size(); begin += slice) {
    const std::size_t count = std::min(slice, rays.size() - begin);
    context.write(queues.rays, &rays[begin], count * sizeof(Ray));
    const OcclusionParams params =
        occlusion_params(*scene.buffers, count / rays_per_point, rays_per_point, footprint);
    if (single)
      occlusion_pass_with(Packets::none, context, queues, *scene.buffers, "occlusion", estimator,
                          params);
    else
      occlusion_pass(context, queues, *scene.buffers, "occlusion", estimator, params);
    context.read(queues.occlusions, &results[begin], count * sizeof(Occlusion));
  }
  context.finish();
  return results;
}

std::vector<SurfacePoint> closest_hits(const Device& device, const DeviceScene& scene,
                                       std::span<const Ray> rays) {
  check_uploaded(scene);
  DeviceContext& context = device.context();
  const Queues queues = make_queues(context, std::min(kQueryRays, rays.size()), 1);
  std::vector<SurfacePoint> points(rays.size());
  for (std::size_t begin = 0; begin < rays.size(); begin += kQueryRays) {
    const std::size_t count = std::min(kQueryRays, rays.size() - begin);
    context.write(queues.rays, &rays[begin], count * sizeof(Ray));
    context.write(queues.points, &points[begin], count * sizeof(SurfacePoint));
    closest_hit_pass(context, *scene.buffers, queues, count);
    context.read(queues.points, &points[begin], count * sizeof(SurfacePoint));
  }
  context.finish();
  return points;
}

}  // namespace dapple
