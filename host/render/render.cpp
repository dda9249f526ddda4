// render(): scene and options in, film and statistics out. Read it to know what dapple does.
#include "dapple/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "device/context.hpp"
#include "device/programs/compiler_processes.hpp"
#include "device/upload/memory_need.hpp"
#include "film/cryptomatte.hpp"
#include "film/film_memory.hpp"
#include "film/layers.hpp"
#include "film/opacity_settings.hpp"
#include "passes/kernel_list.hpp"
#include "render/bias/bias_report.hpp"
#include "render/bias/footprint_pilot.hpp"
#include "render/kept_scene.hpp"
#include "render/partial/resume.hpp"
#include "render/picture.hpp"
#include "render/shutter.hpp"
#include "render/slice_params.hpp"
#include "render/stopwatch.hpp"
#include "render/unseen_lights.hpp"
#include "sampling/bias_estimate.hpp"
#include "sampling/shard.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/corner_normals.hpp"
#include "scene/frame_merge.hpp"
#include "scene/ground.hpp"
#include "scene/lights/default_lights.hpp"

namespace dapple {
namespace {

/// Applies overrides, chooses the view, and adds ground and lights, in this order: the camera
/// frames the scene without the ground, and merging drops lights that nothing can be seen of.
View prepare_scene(Scene& scene, const RenderOptions& options, std::vector<std::string>& notes) {
  check_scene(scene);
  for (const auto& [material, value] : options.opacity) override_opacity(scene, material, value);
  View view = choose_view(scene, options, notes);
  check_film_memory(view, options.light ? scene.lights.size() : 0, options);
  if (options.ground) add_ground(scene, bounds_to_stand_on(scene), options.ground_height);
  if (options.cryptomattes.any() || options.motion) name_objects(scene);
  merge_frame(scene);
  if (options.light && scene.lights.empty()) {
    scene.lights = daylight(view.camera);
    notes.push_back(default_light_note(options.ground));
    check_film_memory(view, scene.lights.size(), options);
  }
  finalize_domes(scene);
  return view;
}

FilmMetadata metadata(const Scene& scene, const View& view, const RenderOptions& options,
                      const DeviceInfo& device, const RenderControl& control) {
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
  set("normals", name_of(options.normals));
  set("footprint", options.footprint);
  if (options.estimator == Estimator::exact) set("roulette", options.roulette);
  if (options.packets != Packets::automatic) set("packets", name_of(options.packets));
  if (limits_bias(options)) set("max_bias", *options.max_bias);
  if (options.target_error > 0) set("target_error", options.target_error);
  if (options.target_rmse > 0) set("target_rmse", options.target_rmse);
  if (is_adaptive(options)) set("max_spp", options.max_spp);
  if (footprint_samples(options) != options.spp) set("footprint_spp", footprint_samples(options));
  set("camera_splitting", options.camera_splitting);
  set(kAmbient, 0.0);  // set_ambient() knows it once there are sums
  set("ao_rays", options.ao_rays);
  set("light_rays", options.light_rays);
  if (options.back) set("back_every", back_group(options));
  if (view.camera.lens_radius > 0) {
    set("aperture", view.camera.lens_radius);
    set("focus_distance", view.camera.focus_distance);
  }
  set("ao_distance", options.ao_distance);
  set("ao_falloff", options.ao_falloff);
  for (auto& setting : opacity_settings(options.opacity)) m.settings.push_back(std::move(setting));
  m.settings.insert(m.settings.end(), control.settings.begin(), control.settings.end());
  return m;
}

/// Whether a shading pass may be needed; whether all normals are flat is not known yet.
bool may_be_shaded(const Scene& scene, const RenderOptions& options) {
  if (options.albedo) return true;
  return options.normals == Normals::shading &&
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return !mesh.normals.empty(); });
}

/// Whether normals are kept though all triangles may be flat just now: all moments of a shutter and
/// all frames of a scene that moves have the same planes and layers.
bool keeps_normals(const Scene& scene, const ShutterScenes& moments) {
  return moments.smooth ||
         (!scene.animations.empty() &&
          std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) {
            return !mesh.normals.empty() && !mesh.has_strands();
          }));
}

UploadOptions uploading_of(const Scene& scene, const RenderOptions& options,
                           const ShutterScenes& moments) {
  const bool shading = options.normals == Normals::shading;
  const bool kept = keeps_normals(scene, moments);
  return {shading && (moments.count == 1 || kept), options.albedo, shading && kept};
}

void add_trace_statistics(RenderStatistics& s, const TracedPicture& picture,
                          const FilmLayout& layout) {
  s.pass_seconds.insert(picture.pass_seconds.begin(), picture.pass_seconds.end());
  s.bytes.film = layout.sum_bytes() + layout.square_bytes();
  s.bytes.queues = picture.queue_bytes;
}

/// The names that Cryptomattes have, if they are requested.
MatteNames matte_names(const Scene& scene, const RenderOptions& options) {
  MatteNames names;
  if (!options.cryptomattes.any()) return names;
  names.objects = scene.objects;
  for (const Material& material : scene.materials) names.materials.push_back(material.name);
  return names;
}

/// Chooses the footprint by a pilot where one is needed. `first_footprint`: of a resumed picture.
/// Returns what is traced: targets are of the noise alone.
RenderOptions with_chosen_footprint(const KeptScene& kept, const PilotPicture& picture,
                                    std::optional<float> first_footprint, RenderOptions& options,
                                    RenderStatistics& statistics) {
  RenderOptions traced = options;
  if (needs_footprint_pilot(options, first_footprint.has_value())) {
    const Stopwatch time;
    const FootprintChoice choice = footprint_pilot(kept, picture, first_footprint);
    options.footprint = choice.footprint;
    if (!choice.note.empty()) statistics.notes.push_back(choice.note);
    traced = options;
    traced.footprint_spp = footprint_samples(options);
    for (float* target : {&traced.target_error, &traced.target_rmse})
      if (*target > 0) *target = noise_target(*target, choice.bias_rmse);
    statistics.pass_seconds["bias pilot"] = time.seconds();
  } else if (limits_bias(options) && !has_bias(options)) {
    statistics.notes.emplace_back(kNothingToLimit);
  }
  statistics.footprint = options.footprint;
  return traced;
}

/// The scene one frame later. If it cannot be rendered, because everything or the camera is scaled
/// to nothing then, nothing moves.
FrameScene next_frame(const Shutter& shutter, int time, const View& view,
                      const RenderOptions& options, std::vector<std::string>& notes) {
  std::vector<std::string> same;  // as of this frame
  try {
    FrameScene next{shutter.next_at(time), {}};
    next.view = prepare_scene(next.scene, options, same);
    return next;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    notes.push_back(
        fmt::format("the frame after this one cannot be shown, so motion is 0: {}", error.what()));
    return {Scene(), view};
  }
}

/// What the hits of camera rays are looked up in, if the options ask for it. `scene` must be on the
/// device, and live as long as the result.
std::unique_ptr<HitLookups> hit_lookups(const KeptScene& kept, const Shutter& shutter, int time,
                                        const Scene& scene, const View& view,
                                        const RenderOptions& options,
                                        std::vector<std::string>& notes) {
  auto lookups = std::make_unique<HitLookups>();
  if (options.cryptomattes.any())
    lookups->mattes.emplace(scene, kept.bvh->bvh(), options.cryptomattes);
  lookups->deep = options.deep;
  if (options.motion)
    lookups->motion.emplace(scene, view, kept.bvh->bvh(),
                            next_frame(shutter, time, view, options, notes));
  return lookups;
}

/// Traces the first moment of the shutter, whose scene is on the device, and then the others: each
/// continues from the sums of those before.
TracedPicture trace(KeptScene& kept, const Shutter& shutter, const Scene& first, const View& view,
                    const RenderOptions& options, const FilmLayout& layout,
                    const std::vector<Light>& lights, TraceControl tracing, TraceState state,
                    RenderStatistics& statistics) {
  const Progress progress = tracing.progress;
  if (shutter.times > 1) {
    tracing.save = [&](const TraceState& saved) { state = saved.copy(); };
    tracing.save_every = std::numeric_limits<double>::infinity();
    tracing.progress = part_of(progress, 1, shutter.times);
  }
  TracedPicture picture = trace_picture(
      *kept.device, kept.on_device, view, until(options, 0, shutter.times), layout, tracing,
      std::move(state), *hit_lookups(kept, shutter, 0, first, view, options, statistics.notes));
  for (int time = 1; time < shutter.times && !picture.interrupted; ++time) {
    Scene moved = shutter.scene_at(time);
    const View moved_view = prepare_scene(moved, options, statistics.notes);
    if (options.light) check_same_lights(lights, moved.lights);
    if (options.cryptomattes.any()) check_same_objects(first, moved);
    const UploadOptions uploading = kept.on_device.buffers->uploaded;
    kept.update_scene(moved, uploading, options.cache, statistics);
    tracing.progress = part_of(progress, time + 1, shutter.times);
    picture = trace_picture(
        *kept.device, kept.on_device, moved_view, until(options, time, shutter.times), layout,
        tracing, std::move(state),
        *hit_lookups(kept, shutter, time, moved, moved_view, options, statistics.notes));
  }
  return picture;
}

/// Uploads the scene while kernels are loaded and other processes compile those that are missing.
/// `moments`: of all, of which this scene is the first.
void put_on_device(KeptScene& kept, const Scene& scene, const View& view,
                   const RenderOptions& options, const ShutterScenes& moments,
                   RenderStatistics& statistics) {
  kept.open(options, statistics);
  const Device& device = *kept.device;
  check_memory(device.info(), min_need(scene), "needs at least");
  check_film_buffer(
      device.info(), view, options.light ? scene.lights : std::vector<Light>{}, options,
      [&] { return keeps_normals(scene, moments) || (moments.count == 1 && is_smooth(scene)); });
  const auto kernels = picture_kernels(device.context(), options, view.camera, scene.lights,
                                       may_be_shaded(scene, options));
  CompilerProcesses processes;
  kept.loader->stop();
  processes.start(device.context(), kernels, CompileTo::machine_code);
  kept.loader->start(kernels);
  kept.update_scene(scene, uploading_of(scene, options, moments), options.cache, statistics);
  kept.compile(kernels, processes, statistics);
}

/// What a picture shows and what its sums mean. `options` are those of its samples.
struct PictureContent {
  const Scene& scene;
  const View& view;
  const RenderOptions& options;
  const std::vector<Light>& lights;
  const MatteNames& names;
  const FilmLayout& layout;
  const FilmMetadata& metadata;
};

/// Describes the picture, so that only runs with the same settings and scene continue from its
/// checkpoints. `asked`: the options before footprints were chosen.
Checkpoint describe(const PictureContent& picture, const KeptScene& kept, const Shutter& shutter,
                    const Settings& asked, const RenderOptions& options) {
  Checkpoint about{
      asked,
      content_settings(options, picture.view, kept.bvh->bvh(), *kept.on_device.buffers),
      footprint_samples(options),
      options.footprint,
      kept.device->info().name,
      record_of(picture.view, picture.options, picture.layout, picture.lights, picture.names,
                picture.metadata)};
  about.content.emplace_back("names of objects", text_checksum(picture.names.objects));
  if (options.motion)
    about.content.emplace_back("next frame (--frame, --fps)", pose_checksum(shutter.next_at(0)));
  return about;
}

/// Makes the film and its statistics from what was traced.
void finish(RenderResult& result, const PictureContent& content, const TracedPicture& picture,
            const RenderControl& control) {
  const auto& [scene, view, options, lights, names, layout, metadata] = content;
  RenderStatistics& statistics = result.statistics;
  add_trace_statistics(statistics, picture, layout);
  result.interrupted = picture.interrupted;
  if (picture.skipped) {
    statistics.notes.push_back(interruption_note(picture, options, control));
    return;
  }
  result.film = {view.width, view.height,
                 view.crop,  develop(picture, layout, options, lights, statistics),
                 metadata,   options.deep ? picture.deep.alpha(picture.samples) : DeepAlpha{}};
  set_ambient(result.film.metadata, statistics.ambient);
  add_largest_irradiances(statistics, picture.largest, layout, lights);
  if (has_bias(options) && options.report_bias > 0)
    add_bias(result, picture, layout, lights, control.resume);
  add_cryptomattes(result.film, picture.mattes, picture.samples, names, options.cryptomattes);
  for (std::string& note : notes_of_unseen_lights(result.film, lights))
    statistics.notes.push_back(std::move(note));
  statistics.notes.insert(statistics.notes.end(), scene.warnings.begin(), scene.warnings.end());
  if (!result.interrupted) return;
  result.film.metadata.settings.emplace_back("interrupted", "yes");
  statistics.notes.push_back(interruption_note(picture, options, control));
}

}  // namespace

struct Renderer::Kept : KeptScene {};

Renderer::Renderer() : kept_(std::make_unique<Kept>()) {}
Renderer::Renderer(const Device& device) : Renderer() { kept_->use(device); }
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::prepare(const RenderOptions& options) {
  RenderStatistics ignored;
  Camera camera;
  camera.lens_radius = options.aperture.value_or(0.0f);
  try {
    kept_->open(options, ignored);
    const DeviceContext& context = kept_->device->context();
    kept_->loader->start(picture_kernels(context, options, camera, daylight(camera), true));
  } catch (const Error&) {  // thrown again by render()
  }
}

RenderResult Renderer::render(Scene scene, RenderOptions options, const RenderControl& control) {
  return render_shutter([&](int) { return std::move(scene); }, 1, std::move(options), control);
}

RenderResult Renderer::render_shutter(const std::function<Scene(int)>& scene_at, int times,
                                      RenderOptions options, const RenderControl& control,
                                      const std::function<Scene(int)>& next_at) {
  const Stopwatch total;
  validate(options);
  const Shutter shutter{scene_at, times, next_at};
  check_shutter(shutter, options, control);
  const ShutterScenes moments = look_at_moments(shutter);
  Scene scene = scene_at(0);
  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.estimator = name_of(options.estimator);

  if (options.spp % times != 0) statistics.notes.push_back(uneven_moments_note(options.spp, times));
  const View view = prepare_scene(scene, options, statistics.notes);
  options.camera_splitting = choose_camera_splitting(options, scene, view);
  const Settings asked = option_settings(options, view);
  const float asked_footprint = options.footprint;
  std::optional<Checkpoint> resumed;
  if (!control.resume.empty()) resumed = resume(control.resume, asked, options, statistics.notes);
  const RenderOptions sampled = by_sample(options);
  // Moved out until the render succeeds: after an error nothing is kept.
  Kept kept = std::exchange(*kept_, {});
  put_on_device(kept, scene, view, sampled, moments, statistics);

  std::vector<Light> lights = options.light ? scene.lights : std::vector<Light>{};
  set_lit_radiance(moments, lights);
  Box3f bounds = kept.bvh->bvh().bounds;
  bounds.extendBy(moments.bounds);
  const MatteNames names = matte_names(scene, options);
  const DeviceBuffers& buffers = *kept.on_device.buffers;
  const FilmLayout layout(view.crop, sampled,
                          film_scales(view, bounds, buffers.light_records, moments.lights), lights,
                          !buffers.corner_normals.empty());
  statistics.seconds.prepare = total.seconds() - counted_seconds(statistics);
  const RenderOptions traced = with_chosen_footprint(
      kept, {view, options, bounds, lights},
      resumed ? std::optional(asked_footprint) : std::nullopt, options, statistics);
  // After the pilot, because the metadata name the footprint that it chose.
  const FilmMetadata about = metadata(scene, view, options, kept.device->info(), control);
  const PictureContent content{scene, view, sampled, lights, names, layout, about};
  TraceControl tracing{control.progress, control.stop, {}, 0, {}, SampleOrder::pixels};
  TraceState state;
  state.first_sample = rays_of(options.shard, options.spp).first * splitting_factor(options);
  if (resumed || !control.checkpoint.empty() || !control.part.empty()) {
    Checkpoint checkpoint = describe(content, kept, shutter, asked, options);
    if (resumed) {
      check_resumed(control.resume, *resumed, checkpoint, layout, sampled, statistics.notes);
      state = std::move(resumed->state);
    }
    write_checkpoints(tracing, control, std::move(checkpoint), result);
  }
  const TracedPicture picture = trace(kept, shutter, scene, view, traced, layout, lights,
                                      std::move(tracing), std::move(state), statistics);
  statistics.seconds.trace = total.seconds() - counted_seconds(statistics);
  finish(result, content, picture, control);
  statistics.seconds.develop = total.seconds() - counted_seconds(statistics);
  *kept_ = std::move(kept);
  statistics.seconds.total = total.seconds();
  return result;
}

RenderResult render(Scene scene, const RenderOptions& options, const RenderControl& control) {
  return Renderer().render(std::move(scene), options, control);
}

}  // namespace dapple
