// render(): scene and options in, film and statistics out. Read it top to bottom to know
// what dapple does.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>

#include "dapple/error.hpp"
#include "dapple/wavefront.hpp"
#include "device/context.hpp"
#include "wavefront/checkpoint.hpp"
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
  settle_domes(scene);
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
  if (options.target_error > 0) set("target_error", options.target_error);
  if (options.target_rmse > 0) set("target_rmse", options.target_rmse);
  if (is_adaptive(options)) set("max_spp", options.max_spp);
  if (footprint_samples(options) != options.spp) set("footprint_spp", footprint_samples(options));
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

/// More samples may be asked for than a checkpoint has, not fewer.
void require_enough_samples(const std::string& path, const TraceState& state,
                            const RenderOptions& options) {
  const bool adaptive = is_adaptive(options);
  const int asked = adaptive ? options.max_spp : options.spp;
  const auto most =
      state.samples.empty() ? 0u : *std::max_element(state.samples.begin(), state.samples.end());
  if (most <= static_cast<std::uint32_t>(asked)) return;
  throw Error(ErrorKind::usage,
              fmt::format("--resume {}: has {} samples a pixel already, {} {} asks for fewer", path,
                          most, adaptive ? "--max-spp" : "--spp", asked));
}

/// The checkpoint `path`, and in `options` the footprints of its beginning.
Checkpoint resume(const std::string& path, const View& view, RenderOptions& options) {
  Checkpoint checkpoint = read_checkpoint(path);
  require_same(path, checkpoint.options, option_settings(options, view));
  require_enough_samples(path, checkpoint.state, options);
  if (options.footprint_spp > 0 && options.footprint_spp != checkpoint.footprint_spp) {
    throw Error(ErrorKind::usage,
                fmt::format("--resume {}: was made with footprint_spp {}, this render has {}", path,
                            checkpoint.footprint_spp, options.footprint_spp));
  }
  options.footprint_spp = checkpoint.footprint_spp;
  return checkpoint;
}

/// Throws Error unless the checkpoint was made of this very picture; notes where it comes from.
void check_resumed(const std::string& path, const Checkpoint& checkpoint, const Settings& content,
                   const FilmLayout& layout, RenderStatistics& statistics) {
  require_same(path, checkpoint.content, content);
  check_state(path, checkpoint.state,
              {layout.pixels, layout.sum_bytes() / sizeof(std::int64_t),
               layout.square_bytes() / sizeof(float)});
  statistics.notes.push_back("went on from " + path);
  if (checkpoint.device == statistics.device) return;
  statistics.notes.push_back(
      fmt::format("{} was traced on {}: the picture's bits are not those of one device", path,
                  checkpoint.device));
}

/// Writes checkpoints as tracing gets on. A failure is kept for the end: a full disk must not cost
/// what is traced.
void write_checkpoints(TraceControl& tracing, const RenderControl& control, Checkpoint about,
                       RenderResult& result) {
  if (control.checkpoint.empty()) return;
  tracing.order = SampleOrder::passes;
  tracing.save_every = control.checkpoint_every;
  tracing.save = [&control, &result, about = std::move(about)](const TraceState& state) {
    const Stopwatch writing;
    result.checkpoint_failure.clear();
    try {
      write_checkpoint(control.checkpoint, about, state);
    } catch (const Error& error) {
      result.checkpoint_failure = error.what();
    }
    result.statistics.seconds.checkpoint += writing.seconds();
  };
}

std::string interruption_note(const TracedPicture& picture, const RenderControl& control) {
  const double samples = std::accumulate(picture.samples.begin(), picture.samples.end(), 0.0) /
                         static_cast<double>(picture.samples.size());
  const std::string next = control.checkpoint.empty()
                               ? "with --checkpoint F it could go on"
                               : "--resume " + control.checkpoint + " goes on";
  return fmt::format("interrupted after {:.3g} samples a pixel on average; {}", samples, next);
}

}  // namespace

RenderResult render(Scene scene, const RenderOptions& asked, const RenderControl& control) {
  const Stopwatch total;
  validate(asked);
  RenderOptions options = asked;
  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.estimator = name_of(options.estimator);

  const View view = furnish(scene, options, statistics.notes);
  std::optional<Checkpoint> resumed;
  if (!control.resume.empty()) resumed = resume(control.resume, view, options);
  const Device device(options.device, options.kernel_dir);
  statistics.device = device.info().name;

  const SceneBvh bvh = build_bvh(scene);
  const Stopwatch uploading;
  const DeviceScene on_device = upload(device, scene, bvh);
  statistics.seconds.upload = uploading.seconds();
  add_bvh_statistics(statistics, bvh, *on_device.buffers);

  prepare_kernels(device.context(), options, scene.lights);
  statistics.seconds.kernel_build = device.context().kernel_build_seconds();

  const std::vector<Light> lights = options.light ? scene.lights : std::vector<Light>{};
  const FilmLayout layout(view, options, bvh.bounds, lights);
  Checkpoint about{
      option_settings(options, view), {}, footprint_samples(options), statistics.device, {}};
  if (resumed || !control.checkpoint.empty())
    about.content = content_settings(options, view, bvh, *on_device.buffers);
  if (resumed) check_resumed(control.resume, *resumed, about.content, layout, statistics);
  TraceControl tracing{control.progress, control.stop, {}, 0, SampleOrder::pixels};
  write_checkpoints(tracing, control, std::move(about), result);

  const Stopwatch trace_time;
  const TracedPicture picture =
      trace_picture(device, on_device, view, options, layout, lights.size(), tracing,
                    resumed ? std::move(resumed->state) : TraceState{});
  statistics.seconds.trace = trace_time.seconds() - statistics.seconds.checkpoint;
  statistics.pass_seconds = picture.pass_seconds;
  statistics.bytes.film = layout.sum_bytes() + layout.square_bytes();
  statistics.bytes.queues = picture.queue_bytes;

  Film& film = result.film;
  film.width = view.width;
  film.height = view.height;
  film.data_window = view.crop;
  film.planes = develop(picture, layout, options, lights, statistics);
  film.metadata = metadata(scene, view, options, device.info());
  for (std::string& warning : scene.warnings) statistics.notes.push_back(std::move(warning));
  result.interrupted = picture.interrupted;
  if (result.interrupted) {
    film.metadata.settings.emplace_back("interrupted", "yes");
    statistics.notes.push_back(interruption_note(picture, control));
  }
  statistics.seconds.total = total.seconds();
  return result;
}

RenderResult render(Scene scene, const RenderOptions& options, const Progress& progress) {
  RenderControl control;
  control.progress = progress;
  return render(std::move(scene), options, control);
}

}  // namespace dapple
