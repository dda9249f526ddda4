// AO and bent normals at given points. In: points and normals. Out: one value for each point.
#include "render/queries/point_occlusion.hpp"

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
#include "passes/queues.hpp"
#include "render/option_check.hpp"
#include "render/queries/free_shifts.hpp"
#include "render/queries/point_checks.hpp"
#include "render/queries/shared_points.hpp"
#include "sampling/point_order.hpp"

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
  OcclusionParams params =
      occlusion_params(scene, points, static_cast<std::size_t>(options.rays), options.footprint);
  set_falloff(params, options.distance, options.falloff);
  return params;
}

/// Results of consecutive points.
struct Results {
  std::span<float> ao;
  std::span<V3f> bent;  ///< empty: not computed
  bool shaded;          ///< some points lie on smooth surfaces
};

/// Of all rays of a point.
struct PointSums {
  double seen = 0;
  V3d direction{0, 0, 0};
  explicit PointSums(std::span<const RaySums> sums) {
    for (const RaySums& sum : sums) {
      seen += double{sum.seen};
      direction += V3d(sum.direction[0], sum.direction[1], sum.direction[2]);
    }
  }
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

/// AO and bent normals of the points by rays in queues; `sums` has room for their sums.
void occlusion_in_passes(DeviceContext& context, const Queues& queues, const DeviceBuffers& scene,
                         const OcclusionOptions& options, const Buffer& sums,
                         const Results& results) {
  const std::size_t points = results.ao.size(), rays = static_cast<std::size_t>(options.rays);
  ao_ray_pass(context, queues, ao_params(options, points, results.shaded));
  occlusion_pass(context, queues, scene, "occlusion", options.estimator,
                 occlusion_params(options, scene, points));
  sum_rays_pass(context, queues, sums, points, rays);
  const HostView view = context.view(sums);
  const std::span<const RaySums> found = view.values<RaySums>();
  const std::size_t per_point = sums_per_point(rays);
  for (std::size_t i = 0; i < points; ++i) {
    const PointSums sum(found.subspan(i * per_point, per_point));
    results.ao[i] = static_cast<float>(sum.seen / static_cast<double>(rays));
    if (!results.bent.empty()) results.bent[i] = V3f(sum.direction / static_cast<double>(rays));
  }
}

void check(const OcclusionOptions& options) {
  check_range("occlusion: rays", options.rays, 1, 1 << 20);
  check_range("occlusion: footprint", double{options.footprint}, 0, 1e6);
  check_range("occlusion: distance", options.distance, 0, 1e30f);
  check_range("occlusion: falloff", double{options.falloff}, 0, 100);
  if (options.falloff > 0 && !(options.distance > 0))
    throw Error(ErrorKind::usage, "occlusion: falloff needs a distance");
}

}  // namespace

PointOcclusion point_occlusion(const Device& device, const DeviceScene& scene,
                               const QueryPoints& given, const OcclusionOptions& options, bool bent,
                               const RenderControl& control) {
  check_uploaded(scene);
  const std::size_t count = given.positions.size();
  if (count != given.normals.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("occlusion: {} points but {} normals", count, given.normals.size()));
  }
  QueryPoints points = given;
  const std::vector<V3f> shifts = free_shifts(device, scene, given);
  points.shifts = shifts;
  DeviceContext& context = device.context();
  const auto rays = static_cast<std::size_t>(options.rays);
  const std::size_t slice = query_points(context, rays, count);
  const bool together = !bent && has_point_ao_pass(context, options.estimator, rays);
  Queues queues =
      together ? make_point_queues(context, slice, rays) : make_queues(context, slice, rays);
  Buffer sums;
  if (!together) {
    sums = context.allocate(slice * sums_per_point(rays) * sizeof(RaySums));
    std::vector<uint> active(slice);
    std::iota(active.begin(), active.end(), 0u);
    context.write(queues.active, active.data(), active.size() * sizeof(uint));
  }
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
      occlusion_in_passes(context, queues, *scene.buffers, options, sums, results);
    for (std::size_t i = 0; i < chosen.size(); ++i) result.ao[chosen[i]] = found.ao[i];
    for (std::size_t i = 0; i < found.bent.size(); ++i) result.bent[chosen[i]] = found.bent[i];
    queues.points = {};  // `batch` is destroyed here, and the buffer refers to its memory
  }
  context.finish();
  if (control.progress) control.progress(1);
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
