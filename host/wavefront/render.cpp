// render(): scene and options in, film and statistics out. Read it top to bottom to know
// what dapple does.
#include <fmt/format.h>

#include <chrono>

#include "dapple/error.hpp"
#include "dapple/wavefront.hpp"
#include "device/context.hpp"
#include "device/memory_need.hpp"
#include "wavefront/passes.hpp"
#include "wavefront/picture.hpp"

namespace dapple {
namespace {

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

const char* name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::exact:
      return "exact";
    case Estimator::prefiltered:
      return "prefiltered";
    case Estimator::packet:
      return "packet";
  }
  return "";
}

const char* name_of(Company company) {
  switch (company) {
    case Company::automatic:
      return "auto";
    case Company::alone:
      return "alone";
    case Company::neighbours:
      return "neighbours";
    case Company::point:
      return "point";
  }
  return "";
}

/// Overrides, lights and ground, in the order that framing needs: the camera sees the
/// scene as it came, without the ground.
View furnish(Scene& scene, const RenderOptions& options, std::vector<std::string>& notes) {
  for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
  View view = choose_view(scene, options, notes);
  if (options.light && scene.lights.empty()) {
    scene.lights.push_back(key_light(scene, view.camera));
    notes.emplace_back(
        "no lights in the scene: added a rect light named key; --lights F brings others");
  }
  if (options.ground) add_ground(scene);
  merge_single_instances(scene);
  return view;
}

FilmMetadata metadata(const Scene& scene, const View& view, const RenderOptions& options,
                      const DeviceInfo& device) {
  FilmMetadata m;
  m.world_to_camera = world_to_exr_camera(view.camera);
  m.world_to_ndc = world_to_ndc(view);
  m.samples = options.spp;
  m.seed = options.seed;
  m.scene = scene.source;
  m.device = device.name;
  m.version = DAPPLE_VERSION;
  const auto set = [&](const char* name, const auto& value) {
    m.settings.emplace_back(name, fmt::format("{}", value));
  };
  set("estimator", name_of(options.estimator));
  set("footprint", options.footprint);
  if (options.trace_with != Company::automatic) set("trace_with", name_of(options.trace_with));
  if (options.target_error > 0) set("target_error", options.target_error);
  if (options.target_rmse > 0) set("target_rmse", options.target_rmse);
  if (is_adaptive(options)) set("max_spp", options.max_spp);
  set("ao_rays", options.ao_rays);
  set("light_rays", options.light_rays);
  set("ao_distance", options.ao_distance);
  set("ao_falloff", options.ao_falloff);
  for (const auto& [material, value] : options.opacity) {
    m.settings.emplace_back("opacity_" + layer_name(material), fmt::format("{}", value));
  }
  return m;
}

void add_bvh_statistics(RenderStatistics& s, const SceneBvh& bvh, const DeviceBuffers& buffers) {
  s.seconds.build = bvh.statistics.build_seconds;
  s.seconds.prefilter = bvh.statistics.prefilter_seconds;
  s.triangles = bvh.statistics.triangles;
  s.nodes = bvh.nodes.size();
  s.bytes.nodes = buffers.nodes.bytes();
  s.bytes.triangles = buffers.blocks.bytes() + buffers.textured.bytes();
  s.bytes.textures = buffers.texels.bytes() + buffers.textures.bytes();
  s.bytes.instances = buffers.instances.bytes();
}

}  // namespace

RenderResult render(Scene scene, const RenderOptions& options, const Progress& progress) {
  const Stopwatch total;
  validate(options);
  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.estimator = name_of(options.estimator);

  const View view = furnish(scene, options, statistics.notes);
  const Device device(options.device, options.kernel_dir, options.trace_with);
  statistics.device = device.info().name;
  for (std::string& note : device.context().notes()) statistics.notes.push_back(std::move(note));

  check_memory(device.info(), least_need(scene), "needs at least");
  const SceneBvh bvh = build_bvh(scene);
  const Stopwatch uploading;
  const DeviceScene on_device = upload(device, scene, bvh);
  statistics.seconds.upload = uploading.seconds();
  add_bvh_statistics(statistics, bvh, *on_device.buffers);

  prepare_kernels(device.context(), options);
  statistics.seconds.kernel_build = device.context().kernel_build_seconds();

  const std::vector<Light> lights = options.light ? scene.lights : std::vector<Light>{};
  const FilmLayout layout(view, options, bvh.bounds, lights.size());
  const Stopwatch tracing;
  const TracedPicture picture =
      trace_picture(device, on_device, view, options, layout, lights.size(), progress);
  statistics.seconds.trace = tracing.seconds();
  statistics.pass_seconds = device.context().pass_seconds();
  statistics.bytes.film = layout.sum_bytes() + layout.square_bytes();
  statistics.bytes.queues = picture.queue_bytes;

  Film& film = result.film;
  film.width = view.width;
  film.height = view.height;
  film.data_window = view.crop;
  film.planes = develop(picture, layout, options, lights, statistics);
  film.metadata = metadata(scene, view, options, device.info());
  for (std::string& warning : scene.warnings) statistics.notes.push_back(std::move(warning));
  statistics.seconds.total = total.seconds();
  return result;
}

}  // namespace dapple
