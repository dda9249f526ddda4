// dapple render: the pipeline from a scene to files, top to bottom.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <thread>

#include "command/command.hpp"
#include "command/interruption.hpp"
#include "command/option_text.hpp"
#include "command/output_paths.hpp"
#include "command/progress.hpp"
#include "command/statistics_text.hpp"
#include "dapple/error.hpp"
#include "dapple/wavefront.hpp"
#include "file/output_file.hpp"
#include "film/exr_output.hpp"

namespace dapple {
namespace {

/// What was typed, before it becomes options.
struct RenderArguments {
  std::string scene, output, png, stats_json, lights, dome;
  double dome_rotation = 0;
  std::string estimator = "prefiltered", passes = "ao,light", trace_with = "auto";
  std::string look_from, look_at, up, crop;
  std::vector<std::string> opacity;
  std::string checkpoint, checkpoint_every = "60s", resume;
  SceneOptions scene_options;
  RenderOptions options;
  bool quiet = false;
};

void add_picture_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  app.add_option("--width", o.width, "Picture width, pixels")->capture_default_str();
  app.add_option("--height", o.height, "Picture height, pixels")->capture_default_str();
  app.add_option(
      "--crop", a.crop,
      "Render only this part: X0,Y0,X1,Y1, pixels from the top left, both ends included");
  app.add_option("--spp", o.spp, "Camera samples a pixel; with a target the least")
      ->capture_default_str();
  app.add_option(
         "--target-error", o.target_error,
         "Sample each pixel until its estimated standard error is below this: of AO, and of "
         "lights relative to their largest unoccluded irradiance; 0: --spp everywhere")
      ->capture_default_str();
  app.add_option(
         "--target-rmse", o.target_rmse,
         "Sample where that lowers the picture's error most, until the estimated root mean square "
         "of its pixels' errors is below this in every pass; 0: don't. Fewer samples than "
         "--target-error takes to the same mean, but pixels' errors differ")
      ->capture_default_str();
  app.add_option("--max-spp", o.max_spp, "With a target the most samples a pixel")
      ->capture_default_str();
  app.add_option("--ao-rays", o.ao_rays, "AO rays a camera sample")->capture_default_str();
  app.add_option("--light-rays", o.light_rays, "Rays a light and camera sample")
      ->capture_default_str();
  app.add_option(
         "--estimator", a.estimator,
         "exact: every surface counts; prefiltered: stop at BVH nodes the ray's footprint covers; "
         "packet: prefiltered, with 4 --ao-rays and more those of a camera sample at once on GPUs "
         "too, as CPUs do anyway")
      ->capture_default_str();
  app.add_option(
         "--footprint", o.footprint,
         "Footprint scale: larger is faster and less noisy, smaller is closer to exact, 0 is exact")
      ->capture_default_str();
  app.add_option(
         "--passes", a.passes,
         "Which passes to make, with commas between: ao, light; visits: what the others' rays cost")
      ->capture_default_str();
  app.add_option("--ao-distance", o.ao_distance,
                 "Surfaces farther than this, in metres, don't occlude; 0: no limit")
      ->capture_default_str();
  app.add_option("--ao-falloff", o.ao_falloff,
                 "Power p: a surface at t counts (1 - t / distance)^p; 0: a hard limit")
      ->capture_default_str();
  app.add_option("--seed", o.seed, "Another seed gives other noise")->capture_default_str();
}

void add_scene_options(CLI::App& app, RenderArguments& a) {
  RenderOptions& o = a.options;
  app.add_option("--camera", o.camera,
                 "Camera by name; default: the scene's first, or one that frames it");
  app.add_option("--look-from", a.look_from, "Camera position X,Y,Z, metres (with --look-at)");
  app.add_option("--look-at", a.look_at, "Where it looks: X,Y,Z");
  app.add_option("--up", a.up, "Its up direction: X,Y,Z; default 0,1,0");
  app.add_option("--fov", o.fov_degrees,
                 "Vertical field of view, degrees; default: the camera's own, or 40");
  app.add_option("--lights", a.lights, "JSON file of lights, in place of the scene's own");
  app.add_option(
      "--dome", a.dome,
      "Latitude-longitude image, OpenEXR or Radiance HDR, that lights the scene from all "
      "around, beside other lights");
  app.add_option("--dome-rotation", a.dome_rotation,
                 "Degrees by which it is turned about +Y, from +Z towards +X")
      ->capture_default_str();
  app.add_option("--light-radius", a.scene_options.light_radius,
                 "Radius that glTF point lights get, metres")
      ->capture_default_str();
  app.add_flag("--allow-outside", a.scene_options.allow_outside,
               "Let a glTF file name buffers and images outside of its folder");
  app.add_option("--opacity", a.opacity,
                 "MATERIAL=VALUE: that opacity, 0 to 1, for a material; may be repeated");
  app.add_flag("--ground", o.ground, "Put an opaque plane under the scene");
}

void add_checkpoint_options(CLI::App& app, RenderArguments& a) {
  CLI::Option& checkpoint = *app.add_option(
      "--checkpoint", a.checkpoint,
      "Keep what is traced in this file, for --resume; also when interrupted, and at the end");
  app.add_option("--checkpoint-every", a.checkpoint_every, "How often, as in 30, 30s, 5m or 1h")
      ->capture_default_str()
      ->needs(&checkpoint);
  app.add_option("--resume", a.resume,
                 "Go on from this checkpoint: same scene and options, but --spp, --max-spp and "
                 "the targets may ask for more");
}

RenderControl to_control(const RenderArguments& a, ProgressBar& progress) {
  return {progress.callback(), save_when_interrupted(), a.checkpoint,
          parse_seconds("--checkpoint-every", a.checkpoint_every), a.resume};
}

RenderOptions to_options(const RenderArguments& a) {
  RenderOptions o = a.options;
  o.estimator = parse_estimator(a.estimator);
  o.trace_with = parse_company(a.trace_with);
  parse_passes(a.passes, o);
  if (!a.crop.empty()) o.crop = parse_crop(a.crop);
  if (!a.look_from.empty() || !a.look_at.empty()) {
    if (a.look_from.empty() || a.look_at.empty()) {
      throw Error(ErrorKind::usage, "--look-from and --look-at go together");
    }
    o.look = LookAt{parse_vector("--look-from", a.look_from), parse_vector("--look-at", a.look_at),
                    a.up.empty() ? V3f(0, 1, 0) : parse_vector("--up", a.up)};
  }
  for (const std::string& text : a.opacity) o.opacity.push_back(parse_opacity(text));
  validate(o);
  return o;
}

void use_lights(Scene& scene, const std::string& path) {
  for (Instance& instance : scene.instances) instance.light = -1;
  scene.lights = load_lights(path);
  for (const Light& light : scene.lights) {
    if (light.environment) scene.files.push_back(light.environment->file);
  }
}

void add_dome(Scene& scene, const RenderArguments& a) {
  Light dome;
  dome.name = "dome";
  dome.kind = LightKind::dome;
  dome.environment = load_environment(a.dome);
  dome.rotation =
      static_cast<float>(std::remainder(a.dome_rotation, 360.0) * std::numbers::pi / 180);
  scene.lights.push_back(std::move(dome));
}

void write_statistics(const RenderStatistics& statistics, const std::string& path) {
  write_whole_file(path, statistics_json(statistics).dump(2) + "\n");
}

/// Where the heat map goes that accompanies a preview: tree.png, tree_visits.png.
std::string visits_path(const std::string& png) {
  const std::filesystem::path path(png);
  return (path.parent_path() / (path.stem().string() + "_visits" + path.extension().string()))
      .string();
}

std::vector<OutputPath> outputs_of(const RenderArguments& a, const RenderOptions& options) {
  std::vector<OutputPath> outputs{{"--output", a.output}};
  if (!a.png.empty()) outputs.push_back({"--png", a.png});
  if (!a.png.empty() && options.visits)
    outputs.push_back({"--png (its heat map)", visits_path(a.png)});
  if (!a.stats_json.empty()) outputs.push_back({"--stats-json", a.stats_json});
  if (!a.checkpoint.empty()) outputs.push_back({"--checkpoint", a.checkpoint});
  return outputs;
}

/// Before anything is read, so that a picture is never lost for want of a place, nor a file
/// that is to be read.
void check_files(const std::vector<OutputPath>& outputs, const RenderArguments& a) {
  check_outputs(outputs);
  std::vector<std::string> inputs;
  if (!a.scene.starts_with("scene:")) inputs.push_back(a.scene);
  if (!a.lights.empty()) inputs.push_back(a.lights);
  if (!a.dome.empty()) inputs.push_back(a.dome);
  check_outputs_spare(outputs, inputs);
  if (a.resume.empty()) return;
  // A checkpoint may take the place of the one that it goes on from, nothing else may.
  std::vector<OutputPath> others = outputs;
  std::erase_if(others, [](const OutputPath& output) { return output.flag == "--checkpoint"; });
  check_outputs_spare(others, {a.resume});
}

/// One line each; a scene may have thousands.
void print_notes(const std::vector<std::string>& notes) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < notes.size() && i < kMost; ++i)
    fmt::print(stderr, "note: {}\n", notes[i]);
  if (notes.size() > kMost) fmt::print(stderr, "note: and {} more\n", notes.size() - kMost);
}

void run_render(const RenderArguments& a) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto start = Clock::now();
  const RenderOptions options = to_options(a);
  ProgressBar progress(a.quiet);
  const RenderControl control = to_control(a, progress);
  const std::vector<OutputPath> outputs = outputs_of(a, options);
  check_files(outputs, a);
  if (!options.cache.empty()) prepare_bvh_cache(options.cache);
  catch_interruptions();

  Scene scene = load_scene(a.scene, a.scene_options);
  if (!a.lights.empty()) use_lights(scene, a.lights);
  check_outputs_spare(outputs, scene.files);
  if (!a.dome.empty()) add_dome(scene, a);
  const double load_seconds = since(start);

  RenderResult result = render(std::move(scene), options, control);
  progress.clear();

  const auto writing = Clock::now();
  use_exr_threads(static_cast<int>(std::thread::hardware_concurrency()));
  write_exr(result.film, a.output, result.interrupted ? Durable::no : Durable::yes);
  if (!a.png.empty()) write_png(result.film, a.png);
  if (!a.png.empty() && options.visits)
    write_heat_map(result.film, visits_path(a.png), "visits.nodes");
  RenderStatistics& statistics = result.statistics;
  statistics.seconds.load = load_seconds;
  statistics.seconds.write = since(writing);
  statistics.seconds.total = since(start);
  if (!a.stats_json.empty()) write_statistics(statistics, a.stats_json);
  if (!result.checkpoint_failure.empty())
    throw Error(ErrorKind::failed, result.checkpoint_failure + "; the picture is written");
  if (a.quiet) return;
  print_notes(statistics.notes);
  fmt::print("{}wrote {}{}\n", statistics_text(statistics), a.output,
             a.png.empty() ? "" : " and " + a.png);
}

}  // namespace

Run add_render_command(CLI::App& app) {
  auto a = std::make_shared<RenderArguments>();
  app.add_option("SCENE", a->scene,
                 "glTF file (.gltf, .glb) or a procedural scene, \"scene:tree?leaves=50000\"")
      ->required();
  app.add_option("-o,--output", a->output, "OpenEXR file to write")->required();
  app.add_option("--png", a->png,
                 "Also write an 8-bit preview, and with visits a heat map F_visits.png");
  add_picture_options(app, *a);
  add_scene_options(app, *a);
  add_checkpoint_options(app, *a);
  app.add_option("--device", a->options.device,
                 "OpenCL device, by part of its name (see dapple devices)");
  app.add_option("--trace-with", a->trace_with,
                 "Whom a ray is traced with, for devices that do better than dapple guesses: auto; "
                 "alone; neighbours; point: the rays of its own point")
      ->capture_default_str();
  app.add_option("--kernel-dir", a->options.kernel_dir,
                 "Read OpenCL kernels from this folder (for developers)");
  app.add_option("--cache", a->options.cache,
                 "Keep built BVHs in this folder, made if there is none, and reuse them; it may be "
                 "deleted at any time");
  app.add_option("--stats-json", a->stats_json, "Write the statistics as JSON");
  app.add_flag("-q,--quiet", a->quiet, "Print nothing but errors");
  app.footer(
      "Example:\n  dapple render tree.glb --opacity leaf=0.85 --spp 64 -o tree.exr --png "
      "tree.png\n"
      "  dapple render tree.glb --spp 1024 -o tree.exr --checkpoint tree.ckpt  # Ctrl-C saves\n"
      "  dapple render tree.glb --spp 1024 -o tree.exr --checkpoint tree.ckpt --resume tree.ckpt"
      "\n\n"
      "Layers: R,G,B,A; ao; bent; light.NAME; N; P; Z; samples; error; visits. Where rays miss, ao "
      "is 1.");
  return [a] { run_render(*a); };
}

}  // namespace dapple
