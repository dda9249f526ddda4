// irradiance(): points and lights in, irradiance out, by the passes of the renderer.
#include "render/queries/point_irradiance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dapple/error.hpp"
#include "dapple/shared/light_record.h"
#include "device/upload/scene_upload.hpp"
#include "passes/light_pass.hpp"
#include "passes/occlusion_pass.hpp"
#include "render/option_check.hpp"
#include "render/queries/free_shifts.hpp"
#include "render/queries/point_checks.hpp"
#include "sampling/point_order.hpp"
#include "scene/images/color.hpp"

namespace dapple {
namespace {

/// The colour of a dome's light, scaled to luminance 1: texel_colour() of dome.clh.
class DomeColor {
 public:
  DomeColor(const DeviceBuffers& scene, const LightRecord& light)
      : light_(light),
        texels_(scene.environment_data.data() + light.environment_first +
                light.environment_height * (std::size_t{light.environment_width} + 1)),
        sine_(std::sin(light.rotation)),
        cosine_(std::cos(light.rotation)) {}

  [[nodiscard]] V3f towards(const float* direction) const {
    using std::numbers::pi_v;
    const float x = direction[0] * cosine_ - direction[2] * sine_;
    const float z = direction[0] * sine_ + direction[2] * cosine_;
    const float u = 0.5f - std::atan2(x, z) * (0.5f / pi_v<float>);
    const float v = std::atan2(std::hypot(x, z), direction[1]) / pi_v<float>;
    const uint width = light_.environment_width, height = light_.environment_height;
    const uint column = std::min(static_cast<uint>(u * static_cast<float>(width)), width - 1);
    const uint row = std::min(static_cast<uint>(v * static_cast<float>(height)), height - 1);
    const float* rgb = texels_ + 3 * (std::size_t{row} * width + column);
    const V3f radiance(rgb[0], rgb[1], rgb[2]);
    const auto value = static_cast<float>(luminance(radiance));
    return value > 0 ? radiance / value : V3f(1, 1, 1);
  }

 private:
  const LightRecord& light_;
  const float* texels_;
  float sine_, cosine_;
};

/// Traces rays to one light from the points in the queue.
class LightTracer {
 public:
  /// `sums` has room for sums of the rays.
  LightTracer(DeviceContext& context, const Queues& queues, const Buffer& sums,
              const DeviceBuffers& scene, const IrradianceOptions& options, bool shaded)
      : context_(context),
        queues_(queues),
        sums_(sums),
        scene_(scene),
        options_(options),
        shaded_(shaded) {}

  /// Sets the values of the points `chosen`, which are in the queue in this order.
  void trace(uint light, const Light& given, std::span<const std::uint32_t> chosen,
             PointIrradiance& result) {
    run_passes(light, static_cast<uint>(chosen.size()));
    const V3d scale = V3d(given.radiance) / static_cast<double>(options_.rays);
    const LightRecord& record = scene_.light_records[light];
    const std::vector<Irradiance> found =
        record.kind == DAPPLE_LIGHT_DOME ? of_dome(record, chosen.size()) : of_sums(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      result.irradiance[chosen[i]] = V3f(found[i].seen * scale);
      result.unoccluded[chosen[i]] = V3f(found[i].all * scale);
    }
  }

 private:
  void run_passes(uint light, uint points) {
    LightParams params{};
    params.point_count = points;
    params.rays = static_cast<uint>(options_.rays);
    params.inverse_count = 1.0f / static_cast<float>(options_.rays);
    params.light = light;
    params.seed = options_.seed;
    params.shaded = shaded_ ? 1u : 0u;
    light_ray_pass(context_, scene_, queues_, params);
    occlusion_pass(context_, queues_, scene_, "light occlusion", options_.estimator,
                   occlusion_params(scene_, points, params.rays, options_.footprint));
  }

  /// Sums over the rays of a point, with occlusion and without.
  struct Irradiance {
    V3d seen{0, 0, 0}, all{0, 0, 0};
  };

  /// From the rays, which see different colours.
  [[nodiscard]] std::vector<Irradiance> of_dome(const LightRecord& record, std::size_t points) {
    const auto rays = static_cast<std::size_t>(options_.rays);
    std::vector<Occlusion> found(points * rays);
    context_.read(queues_.occlusions, found.data(), found.size() * sizeof(Occlusion));
    const HostView view = context_.view(queues_.rays);
    const std::span<const Ray> traced = view.values<Ray>();
    const DomeColor color(scene_, record);
    std::vector<Irradiance> sums(points);
    for (std::size_t r = 0; r < found.size(); ++r) {
      if (!(traced[r].weight > 0)) continue;
      const V3d value = V3d(color.towards(traced[r].direction)) * double{traced[r].weight};
      sums[r / rays].all += value;
      sums[r / rays].seen += value * double{found[r].transmittance};
    }
    return sums;
  }

  [[nodiscard]] std::vector<Irradiance> of_sums(std::size_t points) {
    const auto rays = static_cast<std::size_t>(options_.rays);
    sum_rays_pass(context_, queues_, sums_, points, rays);
    const HostView view = context_.view(sums_);
    const std::span<const RaySums> found = view.values<RaySums>();
    const std::size_t per_point = sums_per_point(rays);
    std::vector<Irradiance> sums(points);
    for (std::size_t k = 0; k < points * per_point; ++k) {
      sums[k / per_point].all += V3d(double{found[k].weight});
      sums[k / per_point].seen += V3d(double{found[k].seen});
    }
    return sums;
  }

  DeviceContext& context_;
  const Queues& queues_;
  const Buffer& sums_;
  const DeviceBuffers& scene_;
  const IrradianceOptions& options_;
  bool shaded_;  ///< some points lie on smooth surfaces
};

void check(std::size_t points, std::size_t normals, std::size_t lights, std::size_t records,
           int rays) {
  if (points != normals)
    throw Error(ErrorKind::usage,
                fmt::format("irradiance: {} points but {} normals", points, normals));
  if (lights != records)
    throw Error(ErrorKind::usage,
                fmt::format("irradiance: {} lights, but {} were uploaded", lights, records));
  check_range("irradiance: rays", rays, 1, 1 << 20);
}

}  // namespace

std::vector<PointIrradiance> point_irradiance(const Device& device, const DeviceScene& scene,
                                              std::span<const Light> lights,
                                              const QueryPoints& given,
                                              const IrradianceOptions& options,
                                              const RenderControl& control) {
  check_uploaded(scene);
  const std::size_t count = given.positions.size();
  check(count, given.normals.size(), lights.size(), scene.buffers->light_records.size(),
        options.rays);
  const std::vector<V3f> zeros(count, V3f(0, 0, 0));
  std::vector<PointIrradiance> result(lights.size(), PointIrradiance{zeros, zeros});
  if (count == 0 || lights.empty()) return result;
  QueryPoints points = given;
  const std::vector<V3f> shifts = free_shifts(device, scene, given);
  points.shifts = shifts;
  DeviceContext& context = device.context();
  const auto rays = static_cast<std::size_t>(options.rays);
  const std::size_t slice = query_points(context, rays, count);
  Queues queues = make_queues(context, slice, rays);
  const Buffer sums = context.allocate(slice * sums_per_point(rays) * sizeof(RaySums));
  std::vector<uint> active(slice);
  std::iota(active.begin(), active.end(), 0u);
  context.write(queues.active, active.data(), active.size() * sizeof(uint));
  const std::vector<std::uint32_t> order = order_along_curve(points.positions);
  for (std::size_t begin = 0; begin < count; begin += slice) {
    report_slice(control, "irradiance", begin, count);
    const auto chosen = std::span(order).subspan(begin, std::min(slice, count - begin));
    const SharedPoints batch(context, points, chosen, scene.buffers->params);
    queues.points = batch.buffer();
    LightTracer tracer(context, queues, sums, *scene.buffers, options, !points.geometric.empty());
    for (uint l = 0; l < lights.size(); ++l) tracer.trace(l, lights[l], chosen, result[l]);
    queues.points = {};  // `batch` is destroyed here, and the buffer refers to its memory
  }
  context.finish();
  if (control.progress) control.progress(1);
  return result;
}

std::vector<PointIrradiance> irradiance(const Device& device, const DeviceScene& scene,
                                        std::span<const Light> lights, std::span<const V3f> points,
                                        std::span<const V3f> normals,
                                        const IrradianceOptions& options,
                                        const RenderControl& control) {
  check_points("irradiance", points, normals);
  if (!(options.footprint >= 0 && options.footprint <= 1e6f))
    throw Error(ErrorKind::usage,
                fmt::format("irradiance: footprint is {:g}; it must be from 0 to 1e+06",
                            options.footprint));
  return point_irradiance(device, scene, lights, {points, normals}, options, control);
}

}  // namespace dapple
