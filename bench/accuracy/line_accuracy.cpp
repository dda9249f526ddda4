#include "accuracy/line_accuracy.hpp"

#include <fmt/format.h>

#include "accuracy/report.hpp"
#include "support/scenes/line_of_points.hpp"
#include "support/scenes/receding_camera.hpp"

namespace dapple::bench {
namespace {

Scene prepared(const std::string& spec, const RenderOptions& options) {
  Scene scene = load_scene(spec);
  for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
  merge_single_instances(scene);
  return scene;
}

/// Builds a scene and uploads it to the device that the options name.
struct Uploaded {
  Uploaded(const std::string& spec, const RenderOptions& options)
      : scene(prepared(spec, options)),
        bvh(build_bvh(scene)),
        device(options.device, options.kernel_dir),
        on_device(upload(device, scene, bvh)) {}
  Scene scene;
  SceneBvh bvh;
  Device device;
  DeviceScene on_device;
};

void measure_points(const Uploaded& scene, const std::string& what, const std::vector<Ray>& rays,
                    const LineAccuracyOptions& options, std::vector<LineAccuracyRow>& rows) {
  const std::vector<V3f> points =
      popping::line_through(scene.bvh.bounds, options.points, options.points);
  const auto traced = [&](Estimator estimator, float footprint) {
    return popping::transmittances(scene.device, scene.on_device, points, rays, estimator,
                                   footprint);
  };
  const std::vector<float> exact = traced(Estimator::exact, 0);
  for (const float footprint : options.footprints) {
    const auto found = popping::largest(
        popping::steps(exact, traced(Estimator::prefiltered, footprint), rays.size()));
    rows.push_back({what, footprint, found.exact, found.prefiltered, found.excess, found.error});
  }
}

void measure_camera(const Uploaded& scene, const LineAccuracyOptions& options,
                    std::vector<LineAccuracyRow>& rows) {
  const popping::RecedingCamera path(scene.bvh.bounds, options.frames, 4);
  const popping::FrameTracer tracer(scene.device, scene.on_device, scene.bvh.bounds, options.render,
                                    options.size, options.seeds);
  const std::vector<popping::Frame> exact = tracer.frames(path, Estimator::exact, 0);
  for (const float footprint : options.footprints) {
    const auto found = popping::largest(
        popping::steps(exact, tracer.frames(path, Estimator::prefiltered, footprint)));
    rows.push_back(
        {"camera", footprint, found.exact, found.prefiltered, found.excess, found.error});
  }
}

}  // namespace

std::vector<LineAccuracyRow> measure_line(const std::string& spec,
                                          const LineAccuracyOptions& options) {
  const Uploaded scene(spec, options.render);
  const popping::Strata strata{options.rays_across, options.rays_across};
  std::vector<LineAccuracyRow> rows;
  measure_points(scene, "hemisphere", popping::hemisphere_rays(strata, strata.count()), options,
                 rows);
  measure_points(scene, "sphere", popping::sphere_rays(strata, strata.count()), options, rows);
  measure_camera(scene, options, rows);
  return rows;
}

std::string line_text(const std::vector<LineAccuracyRow>& rows) {
  std::vector<std::vector<std::string>> cells{
      {"moved", "footprint", "exact step", "prefiltered step", "excess", "standard error"}};
  for (const LineAccuracyRow& row : rows) {
    cells.push_back({row.what, fmt::format("{:g}", row.footprint), fmt::format("{:.4f}", row.exact),
                     fmt::format("{:.4f}", row.prefiltered), fmt::format("{:+.4f}", row.excess),
                     fmt::format("{:.4f}", row.error)});
  }
  return "Largest changes of AO from one point or frame to the next\n" + table_text(cells);
}

}  // namespace dapple::bench
