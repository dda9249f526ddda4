// dapple render: the pipeline from a scene to files, top to bottom.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "command/command.hpp"
#include "command/option_text.hpp"
#include "command/output_paths.hpp"
#include "command/progress.hpp"
#include "command/statistics_text.hpp"
#include "dapple/error.hpp"
#include "dapple/wavefront.hpp"
#include "film/output_file.hpp"

namespace dapple {
namespace {

/// What was typed, before it becomes options.
struct RenderArguments {
  std::string scene, output, png, stats_json, lights;
  std::string estimator = "prefiltered", passes = "ao,light";
  std::string look_from, look_at, up, crop;
  std::vector<std::string> opacity;
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
  app.add_option("--light-radius", a.scene_options.light_radius,
                 "Radius that glTF point lights get, metres")
      ->capture_default_str();
  app.add_flag("--allow-outside", a.scene_options.allow_outside,
               "Let a glTF file name buffers and images outside of its folder");
  app.add_option("--opacity", a.opacity,
                 "MATERIAL=VALUE: that opacity, 0 to 1, for a material; may be repeated");
  app.add_flag("--ground", o.ground, "Put an opaque plane under the scene");
}

RenderOptions to_options(const RenderArguments& a) {
  RenderOptions o = a.options;
  o.estimator = parse_estimator(a.estimator);
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
  return outputs;
}

/// Before anything is read, so that a picture is never lost for want of a place, nor a file
/// that is to be read.
void check_files(const std::vector<OutputPath>& outputs, const RenderArguments& a) {
  check_outputs(outputs);
  std::vector<std::string> inputs;
  if (!a.scene.starts_with("scene:")) inputs.push_back(a.scene);
  if (!a.lights.empty()) inputs.push_back(a.lights);
  check_outputs_spare(outputs, inputs);
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
  const std::vector<OutputPath> outputs = outputs_of(a, options);
  check_files(outputs, a);

  Scene scene = load_scene(a.scene, a.scene_options);
  check_outputs_spare(outputs, scene.files);
  if (!a.lights.empty()) use_lights(scene, a.lights);
  const double load_seconds = since(start);

  ProgressBar progress(a.quiet);
  RenderResult result = render(std::move(scene), options, progress.callback());
  progress.clear();

  const auto writing = Clock::now();
  write_exr(result.film, a.output);
  if (!a.png.empty()) write_png(result.film, a.png);
  if (!a.png.empty() && options.visits)
    write_heat_map(result.film, visits_path(a.png), "visits.nodes");
  RenderStatistics& statistics = result.statistics;
  statistics.seconds.load = load_seconds;
  statistics.seconds.write = since(writing);
  statistics.seconds.total = since(start);
  if (!a.stats_json.empty()) write_statistics(statistics, a.stats_json);
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
  app.add_option("--device", a->options.device,
                 "OpenCL device, by part of its name (see dapple devices)");
  app.add_option("--kernel-dir", a->options.kernel_dir,
                 "Read OpenCL kernels from this folder (for developers)");
  app.add_option("--stats-json", a->stats_json, "Write the statistics as JSON");
  app.add_flag("-q,--quiet", a->quiet, "Print nothing but errors");
  app.footer(
      "Example:\n  dapple render tree.glb --opacity leaf=0.85 --spp 64 -o tree.exr --png "
      "tree.png\n\n"
      "Layers: R,G,B,A; ao; bent; light.NAME; N; P; Z; samples; error; visits. Where rays miss, ao "
      "is 1.");
  return [a] { run_render(*a); };
}

}  // namespace dapple
