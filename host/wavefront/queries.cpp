// Rays and points that no camera made: the raw queries, and AO for baking.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dapple/error.hpp"
#include "dapple/wavefront.hpp"
#include "device/context.hpp"
#include "device/scene_upload.hpp"
#include "wavefront/passes.hpp"
#include "wavefront/point_order.hpp"

namespace dapple {
namespace {

/// Rays a launch, so that no launch runs long enough to trip a watchdog.
constexpr std::size_t kSlice = 1u << 18;

OcclusionParams occlusion_params(const DeviceBuffers& scene, std::size_t points,
                                 std::size_t rays_per_point, float footprint) {
  OcclusionParams params{};
  params.scene = scene.params;
  params.ray_count = static_cast<uint>(points * rays_per_point);
  params.rays_per_point = static_cast<uint>(rays_per_point);
  params.footprint = footprint;
  return params;
}

/// The offset that clears the rounding of coordinates given as floats.
SurfacePoint surface_point(const V3f& position, const V3f& normal, std::size_t index) {
  SurfacePoint point{};
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    point.position[axis] = position[axis];
    point.normal[axis] = normal[axis];
    largest = std::max(largest, std::fabs(position[axis]));
  }
  point.offset = largest * 4e-6f;
  point.pixel = static_cast<uint>(index);
  return point;
}

/// Throws Error usage unless the rays are whole points, all of a point from one place to one
/// light.
void check_points(std::span<const Ray> rays, std::size_t rays_per_point) {
  if (rays_per_point < 1 || rays.size() % rays_per_point != 0) {
    throw Error(ErrorKind::usage, fmt::format("trace: {} rays are no whole number of points of {}",
                                              rays.size(), rays_per_point));
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
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
  DeviceContext& context = device.context();
  // Points traced together share a light: where there are several, each ray goes alone.
  const bool one_light = std::all_of(rays.begin(), rays.end(),
                                     [&](const Ray& ray) { return ray.light == rays[0].light; });
  if (!one_light) rays_per_point = 1;
  const std::size_t slice = std::max<std::size_t>(1, kSlice / rays_per_point) * rays_per_point;
  const Queues queues = make_queues(context, std::min(slice, rays.size()), 1);
  std::vector<Occlusion> results(rays.size());
  for (std::size_t begin = 0; begin < rays.size(); begin += slice) {
    const std::size_t count = std::min(slice, rays.size() - begin);
    context.write(queues.rays, &rays[begin], count * sizeof(Ray));
    occlusion_pass(
        context, queues, *scene.buffers, "occlusion", estimator,
        occlusion_params(*scene.buffers, count / rays_per_point, rays_per_point, footprint));
    context.read(queues.occlusions, &results[begin], count * sizeof(Occlusion));
  }
  context.finish();
  return results;
}

std::vector<SurfacePoint> closest_hits(const Device& device, const DeviceScene& scene,
                                       std::span<const Ray> rays) {
  DeviceContext& context = device.context();
  const Queues queues = make_queues(context, std::min(kSlice, rays.size()), 1);
  std::vector<SurfacePoint> points(rays.size());
  for (std::size_t begin = 0; begin < rays.size(); begin += kSlice) {
    const std::size_t count = std::min(kSlice, rays.size() - begin);
    context.write(queues.rays, &rays[begin], count * sizeof(Ray));
    context.write(queues.points, &points[begin], count * sizeof(SurfacePoint));
    closest_hit_pass(context, *scene.buffers, queues, count);
    context.read(queues.points, &points[begin], count * sizeof(SurfacePoint));
  }
  context.finish();
  return points;
}

std::vector<float> occlusion(const Device& device, const DeviceScene& scene,
                             std::span<const V3f> points, std::span<const V3f> normals,
                             const OcclusionOptions& options) {
  if (points.size() != normals.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("occlusion: {} points but {} normals", points.size(), normals.size()));
  }
  if (options.rays < 1 || options.rays > 1 << 20) {
    throw Error(ErrorKind::usage, fmt::format("occlusion: rays is {}; it must be from 1 to {}",
                                              options.rays, 1 << 20));
  }
  DeviceContext& context = device.context();
  const auto rays = static_cast<std::size_t>(options.rays);
  const std::size_t slice = std::max<std::size_t>(1, kSlice / rays);
  const Queues queues = make_queues(context, std::min(slice, points.size()), rays);
  const std::vector<std::uint32_t> order = order_along_curve(points);
  std::vector<float> ao(points.size());
  std::vector<Occlusion> found;
  for (std::size_t begin = 0; begin < points.size(); begin += slice) {
    const std::size_t count = std::min(slice, points.size() - begin);
    std::vector<SurfacePoint> batch;
    std::vector<uint> active;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t point = order[begin + i];
      batch.push_back(surface_point(points[point], normals[point], point));
      active.push_back(static_cast<uint>(i));
    }
    context.write(queues.points, batch.data(), count * sizeof(SurfacePoint));
    context.write(queues.active, active.data(), count * sizeof(uint));
    const float t_max =
        options.distance > 0 ? options.distance : std::numeric_limits<float>::infinity();
    ao_ray_pass(context, queues,
                {static_cast<uint>(count), static_cast<uint>(rays), 1.0f / static_cast<float>(rays),
                 t_max, options.seed, 1u});
    OcclusionParams params = occlusion_params(*scene.buffers, count, rays, options.footprint);
    if (options.distance > 0 && options.falloff > 0) {
      params.inverse_distance = 1.0f / options.distance;
      params.falloff = options.falloff;
    }
    occlusion_pass(context, queues, *scene.buffers, "occlusion", options.estimator, params);
    found.resize(count * rays);
    context.read(queues.occlusions, found.data(), found.size() * sizeof(Occlusion));
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0;
      for (std::size_t r = 0; r < rays; ++r) sum += found[i * rays + r].transmittance;
      ao[order[begin + i]] = static_cast<float>(sum / static_cast<double>(rays));
    }
  }
  context.finish();
  return ao;
}

}  // namespace dapple
