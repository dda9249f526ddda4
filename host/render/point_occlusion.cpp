// AO and bent normals at given points. In: points and normals. Out: one value for each point.
#include "render/point_occlusion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dapple/error.hpp"
#include "dapple/render.hpp"
#include "device/context.hpp"
#include "device/upload/scene_upload.hpp"
#include "passes/occlusion_pass.hpp"
#include "passes/point_order.hpp"
#include "passes/queues.hpp"
#include "render/option_check.hpp"
#include "render/point_checks.hpp"
#include "render/shared_points.hpp"

namespace dapple {
namespace {

AoParams ao_params(const OcclusionOptions& options, std::size_t points, bool shaded) {
  AoParams params{};
  params.point_count = static_cast<uint>(points);
  params.rays = static_cast<uint>(options.rays);
  params.inverse_count = 1.0f / static_cast<float>(options.rays);
  params.t_max = options.distance > 0 ? options.distance : std::numeric_limits<float>::infinity();
  params.seed = options.seed;
  params.whole_sets = 1;
  params.shaded = shaded ? 1u : 0u;
  return params;
}

OcclusionParams occlusion_params(const OcclusionOptions& options, const DeviceBuffers& scene,
                                 std::size_t points) {
  OcclusionParams params{};
  params.scene = scene.params;
  params.rays_per_point = static_cast<uint>(options.rays);
  params.ray_count = static_cast<uint>(points) * params.rays_per_point;
  params.footprint = options.footprint;
  if (options.distance > 0 && options.falloff > 0) {
    params.inverse_distance = 1.0f / options.distance;
    params.falloff = options.falloff;
  }
  return params;
}

/// Results of consecutive points.
struct Results {
  std::span<float> ao;
  std::span<V3f> bent;  ///< empty: not computed
  bool shaded;          ///< some points lie on smooth surfaces
};

/// AO of the points in the queue by point_ao_pass(); rays stay on the device.
void occlusion_at_once(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                       const OcclusionOptions& options, const Results& results) {
  const std::size_t points = results.ao.size();
  point_ao_pass(context, queues, scene, options.estimator,
                ao_params(options, points, results.shaded),
                occlusion_params(options, scene, points));
  context.read(queues.occlusions, results.ao.data(), results.ao.size_bytes());
}

/// AO and bent normals of the points by rays in queues.
void occlusion_in_passes(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                         const OcclusionOptions& options, const Results& results) {
  const std::span<float> ao = results.ao;
  std::vector<uint> active(ao.size());
  std::iota(active.begin(), active.end(), 0u);
  context.write(queues.active, active.data(), active.size() * sizeof(uint));
  ao_ray_pass(context, queues, ao_params(options, ao.size(), results.shaded));
  occlusion_pass(context, queues, scene, "occlusion", options.estimator,
                 occlusion_params(options, scene, ao.size()));
  const auto rays = static_cast<std::size_t>(options.rays);
  std::vector<Occlusion> found(ao.size() * rays);
  context.read(queues.occlusions, found.data(), found.size() * sizeof(Occlusion));
  HostView view;
  if (!results.bent.empty() || results.shaded) view = context.view(queues.rays);
  const std::span<const Ray> traced = view.values<Ray>();
  for (std::size_t i = 0; i < found.size() && results.shaded; ++i)
    found[i].transmittance *= traced[i].weight;
  for (std::size_t i = 0; i < ao.size(); ++i) {
    double sum = 0;
    for (std::size_t r = 0; r < rays; ++r) sum += found[i * rays + r].transmittance;
    ao[i] = static_cast<float>(sum / static_cast<double>(rays));
  }
  if (results.bent.empty()) return;
  for (std::size_t i = 0; i < ao.size(); ++i) {
    V3d sum(0, 0, 0);
    for (std::size_t r = i * rays; r < (i + 1) * rays; ++r) {
      const float* d = traced[r].direction;
      sum += V3d(d[0], d[1], d[2]) * double{found[r].transmittance};
    }
    results.bent[i] = V3f(sum / static_cast<double>(rays));
  }
}

void check(const OcclusionOptions& options) {
  check_range("occlusion: rays", options.rays, 1, 1 << 20);
  check_range("occlusion: footprint", double{options.footprint}, 0, 1e6);
  check_range("occlusion: distance", double{options.distance}, 0, 1e30);
  check_range("occlusion: falloff", double{options.falloff}, 0, 100);
  if (options.falloff > 0 && !(options.distance > 0))
    throw Error(ErrorKind::usage, "occlusion: falloff needs a distance");
}

}  // namespace

PointOcclusion point_occlusion(const Device& device, const DeviceScene& scene,
                               const QueryPoints& points, const OcclusionOptions& options,
                               bool bent, const RenderControl& control) {
  check_uploaded(scene);
  const std::size_t count = points.positions.size();
  if (count != points.normals.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("occlusion: {} points but {} normals", count, points.normals.size()));
  }
  DeviceContext& context = device.context();
  const auto rays = static_cast<std::size_t>(options.rays);
  const std::size_t slice = std::min(std::max<std::size_t>(1, kQueryRays / rays), count);
  const bool together = !bent && has_point_ao_pass(context, options.estimator, rays);
  Queues queues =
      together ? make_point_queues(context, slice, rays) : make_queues(context, slice, rays);
  const std::vector<std::uint32_t> order = order_along_curve(points.positions);
  PointOcclusion result{std::vector<float>(count), std::vector<V3f>(bent ? count : 0)};
  PointOcclusion found;
  for (std::size_t begin = 0; begin < count; begin += slice) {
    report_slice(control, "occlusion", begin, count);
    const auto chosen = std::span(order).subspan(begin, std::min(slice, count - begin));
    const SharedPoints batch(context, points, chosen, scene.buffers->params);
    queues.points = batch.buffer();
    found.ao.resize(chosen.size());
    found.bent.resize(bent ? chosen.size() : 0);
    const Results results{found.ao, found.bent, !points.geometric.empty()};
    if (together)
      occlusion_at_once(context, queues, *scene.buffers, options, results);
    else
      occlusion_in_passes(context, queues, *scene.buffers, options, results);
    for (std::size_t i = 0; i < chosen.size(); ++i) result.ao[chosen[i]] = found.ao[i];
    for (std::size_t i = 0; i < found.bent.size(); ++i) result.bent[chosen[i]] = found.bent[i];
    queues.points = {};  // `batch` is destroyed here, and the buffer refers to its memory
  }
  context.finish();
  return result;
}

std::vector<float> occlusion(const Device& device, const DeviceScene& scene,
                             std::span<const V3f> points, std::span<const V3f> normals,
                             const OcclusionOptions& options, const RenderControl& control) {
  check_points("occlusion", points, normals);
  check(options);
  return point_occlusion(device, scene, {points, normals}, options, false, control).ao;
}

}  // namespace dapple
