// dapple plan: what a render would take on this machine. In: the options of dapple render. Out:
// memory, seconds of a shard and bytes of files, from trials: smaller images with fewer samples of
// each pixel. The first has a thousandth of the samples; longer ones follow while the time is
// short.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "camera/view.hpp"
#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_paths.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/progress.hpp"
#include "commands/render/render_arguments.hpp"
#include "commands/render/render_values.hpp"
#include "commands/render/shot.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "files/private_folder.hpp"
#include "film/film_memory.hpp"
#include "sampling/shard.hpp"

namespace dapple {
namespace {

/// Part of the samples that the first trial has, and the least number of its camera rays: with
/// fewer, the time is that of starting kernels.
constexpr double kShare = 1e-3, kLeastRays = 1 << 16;

/// While a trial takes less, a longer one follows, of so many times the rays.
constexpr double kLongEnough = 0.4, kLonger = 8;

/// Samples of a pixel in trials: as in whole renders, many samples share nodes and caches.
constexpr int kTrialSamples = 64;

struct Plan {
  double pixels = 0, rays = 0;  ///< of the image
  double shard_rays = 0;        ///< of one shard, the largest
  int shards = 1;
  double frames = 1;
  double trial_rays = 0, trial_seconds = 0;
  double before_seconds = 0, ray_seconds = 0;  ///< of a shard
  double memory_bytes = 0, image_bytes = 0, part_bytes = 0;
  std::string device;
};

PixelRect window_of(const RenderOptions& options) {
  return options.crop.value_or(PixelRect{0, 0, options.width - 1, options.height - 1});
}

double pixels_of(const RenderOptions& options) {
  const PixelRect window = window_of(options);
  return double{1} * window.width() * window.height();
}

/// The same view with about `rays` camera rays, in fewer and larger pixels, and fewer samples of
/// each. Footprints stay as large as those of `options`.
RenderOptions trial_options(const RenderOptions& options, double rays) {
  RenderOptions trial = options;
  trial.shard = {};
  trial.target_error = trial.target_rmse = 0;
  trial.max_bias = 0.0f;
  trial.spp = std::min(options.spp, kTrialSamples);
  const double share = std::min(1.0, rays / (pixels_of(options) * trial.spp));
  const double side = std::sqrt(share);
  const double footprints = std::min(footprint_samples(options) / share, double{1 << 20});
  trial.footprint_spp = static_cast<int>(footprints);
  const auto scaled = [&](int length) { return static_cast<int>(std::ceil(length * side)); };
  trial.width = scaled(options.width);
  trial.height = scaled(options.height);
  const auto at = [&](int pixel, int size) {
    return std::min(size - 1, static_cast<int>(pixel * side));
  };
  if (const auto& c = options.crop)
    trial.crop = PixelRect{at(c->x0, trial.width), at(c->y0, trial.height), at(c->x1, trial.width),
                           at(c->y1, trial.height)};
  return trial;
}

/// A folder for the trial's files, removed at the end. A signal handler can remove it only while it
/// is empty, as it is while a trial is traced; what a killed trial leaves, the next one removes.
class TrialFolder {
 public:
  TrialFolder() {
    const char* set = std::getenv("TMPDIR");
    const std::string parent = set && *set ? set : "/tmp";
    try {
      std::filesystem::directory_iterator must_exist(parent);
      folder_.emplace(parent);
    } catch (const std::filesystem::filesystem_error& error) {
      refuse(parent, error.code().message());
    } catch (const Error& error) {
      refuse(parent, error.what());
    }
    remove_when_interrupted(folder_->path().string());
  }
  ~TrialFolder() {
    folder_.reset();
    remove_when_interrupted("");
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  [[nodiscard]] std::string file(const char* name) const {
    return (folder_->path() / name).string();
  }
  /// Removes a file of the folder; returns its size.
  [[nodiscard]] static double take_bytes(const std::string& file) {
    const auto bytes = static_cast<double>(std::filesystem::file_size(file));
    std::filesystem::remove(file);
    return bytes;
  }

 private:
  [[noreturn]] static void refuse(const std::string& parent, const std::string& reason) {
    throw Error(ErrorKind::failed, fmt::format("cannot make a folder in {} (TMPDIR, or else /tmp): "
                                               "{}",
                                               parent, reason));
  }

  std::optional<PrivateFolder> folder_;
};

/// Of the process: the largest so far.
double resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

struct Trial {
  double pixels = 0, rays = 0;
  double seconds = 0;         ///< of tracing
  double before_seconds = 0;  ///< of what comes before
  double part_bytes = 0;      ///< of the part with its sums
};

Trial trace_trial(Renderer& renderer, Scene scene, const RenderOptions& options,
                  const RenderControl& control, RenderResult& result) {
  result = renderer.render(std::move(scene), options, control);
  const auto& seconds = result.statistics.seconds;
  const double pixels = pixels_of(options);
  Trial trial{pixels, pixels * options.spp, seconds.trace, seconds.total - seconds.trace};
  if (!result.interrupted) trial.part_bytes = TrialFolder::take_bytes(control.part);
  return trial;
}

/// Seconds of `rays` camera rays, if they grow as from a trial to a longer one.
double seconds_of(double rays, const Trial& shorter, const Trial& longer) {
  if (longer.rays <= shorter.rays) return longer.seconds * rays / longer.rays;
  const double of_ray =
      std::max(0.0, longer.seconds - shorter.seconds) / (longer.rays - shorter.rays);
  return std::max(longer.seconds * std::min(1.0, rays / longer.rays),
                  longer.seconds + of_ray * (rays - longer.rays));
}

/// Bytes that more pixels take. Images whose sums are saved have them twice.
double film_bytes(const RenderArguments& a, const RenderOptions& options, std::size_t lights,
                  double pixels) {
  const bool saved = is_part_path(a.output) || !a.checkpoint.empty();
  const auto of_pixel = static_cast<double>(film_bytes_per_pixel(lights, options));
  return pixels * (saved ? of_pixel : of_pixel / 2);
}

/// `scene_now` returns the scene, each time the same. None: a signal came.
std::optional<Plan> plan_of(const RenderArguments& a, const RenderOptions& options,
                            const std::function<Scene()>& scene_now) {
  Plan plan;
  plan.pixels = pixels_of(options);
  plan.rays = plan.pixels * options.spp;
  plan.shards = options.shard.count;
  plan.shard_rays = plan.pixels * std::ceil(double{1} * options.spp / plan.shards);
  if (!a.frames.empty()) plan.frames = static_cast<double>(parse_frames(a.frames).count());

  const TrialFolder folder;
  RenderControl control;
  ProgressBar progress(a.quiet, "trial");
  control.progress = progress.callback();
  control.stop = save_when_interrupted();
  control.part = folder.file("trial.dapple");
  Scene scene = scene_now();
  const std::size_t lights = options.light ? std::max<std::size_t>(2, scene.lights.size()) : 0;
  std::vector<std::string> notes;
  check_film_memory(choose_view(scene, options, notes), lights, options);
  Renderer renderer;
  RenderResult result;
  double rays = std::max(kShare * plan.rays, kLeastRays);
  Trial shorter;
  Trial longer =
      trace_trial(renderer, std::move(scene), trial_options(options, rays), control, result);
  plan.before_seconds = longer.before_seconds;
  while (!result.interrupted && longer.seconds < kLongEnough && longer.pixels < plan.pixels) {
    rays *= kLonger;
    shorter = longer;
    longer = trace_trial(renderer, scene_now(), trial_options(options, rays), control, result);
  }
  progress.clear();
  if (result.interrupted) return {};
  plan.device = result.statistics.device;
  plan.trial_rays = longer.rays;
  plan.trial_seconds = longer.seconds;
  plan.ray_seconds = seconds_of(plan.shard_rays, shorter, longer);
  plan.memory_bytes =
      resident_bytes() + film_bytes(a, options, lights, plan.pixels - longer.pixels);
  const std::string image = folder.file("trial.exr");
  write_exr(result.film, image, to_format(a));
  plan.image_bytes = TrialFolder::take_bytes(image) * plan.pixels / longer.pixels;
  plan.part_bytes = longer.part_bytes * plan.pixels / longer.pixels;
  return plan;
}

nlohmann::ordered_json plan_json(const Plan& p) {
  return {{"pixels", p.pixels},
          {"camera_rays", p.rays},
          {"frames", p.frames},
          {"shards", p.shards},
          {"trial", {{"camera_rays", p.trial_rays}, {"seconds", p.trial_seconds}}},
          {"shard", {{"seconds_before", p.before_seconds}, {"seconds_of_rays", p.ray_seconds}}},
          {"memory_bytes", p.memory_bytes},
          {"image_bytes", p.image_bytes},
          {"part_bytes", p.part_bytes},
          {"device", p.device}};
}

std::string duration_text(double seconds) {
  if (seconds < 100) return fmt::format("{:.1f} s", seconds);
  if (seconds < 6000) return fmt::format("{:.1f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string plan_text(const Plan& p) {
  const double shard = p.before_seconds + p.ray_seconds;
  const double tasks = p.shards * p.frames;
  std::string text = fmt::format("trial: {:.0f} of {:.0f} camera rays in {} on {}\n", p.trial_rays,
                                 p.rays, duration_text(p.trial_seconds), p.device);
  text += fmt::format("memory: about {}\n", bytes_text(p.memory_bytes));
  text += fmt::format("{}: about {}, {} of them before the first ray\n",
                      p.shards > 1 ? "a shard" : "an image", duration_text(shard),
                      duration_text(p.before_seconds));
  if (tasks > 1)
    text +=
        fmt::format("all {:.0f}: about {} on this machine\n", tasks, duration_text(tasks * shard));
  text += fmt::format("files: about {} an image, {} a part\n", bytes_text(p.image_bytes),
                      bytes_text(p.part_bytes));
  return text;
}

/// A plan writes statistics alone.
std::vector<OutputPath> outputs_of(const RenderArguments& a) {
  if (a.stats_json.empty()) return {};
  return {{"--stats-json", a.stats_json}};
}

void run_plan(RenderArguments a) {
  if (a.output.empty()) a.output = a.shard.empty() ? "image.exr" : "part.dapple";
  RenderOptions options = to_options(a);
  if (is_adaptive(options))
    throw Error(ErrorKind::usage,
                "dapple plan needs --spp: with a target nobody knows the samples beforehand");
  if (!a.shutter.empty() || options.motion)
    throw Error(ErrorKind::usage,
                "dapple plan does not support moving scenes: leave out --shutter and --passes "
                "motion");
  if (options.deep)
    throw Error(ErrorKind::usage, "dapple plan knows no deep files: leave --deep out");
  if (!a.resume.empty() || !a.resume_or_begin.empty())
    throw Error(ErrorKind::usage, "dapple plan plans whole renders: leave --resume out");
  to_format(a);  // checks it before anything is traced
  const std::vector<OutputPath> outputs = outputs_of(a);
  check_outputs(outputs);
  std::vector<std::string> inputs;
  for (const std::string& path : {a.scene, a.lights, a.dome})
    if (!path.empty() && !path.starts_with("scene:")) inputs.push_back(path);
  check_outputs_spare(outputs, inputs);
  catch_interruptions();
  std::optional<double> seconds = a.frame;
  if (!a.frames.empty())
    seconds = static_cast<double>(parse_frames(a.frames).first) / frames_per_second(a);
  if ((options.max_bias > 0 || chooses_footprint(options)) && !a.quiet)
    tell("note: the plan is for --footprint {}; a smaller one may be chosen (--max-bias)\n",
         options.footprint);
  Shot shot(a, options);
  const std::optional<Plan> plan = plan_of(a, options, [&] {
    Scene scene = shot.frame(seconds);
    check_outputs_spare(outputs, scene.files);
    return scene;
  });
  if (!plan) return;
  if (!a.stats_json.empty()) write_whole_file(a.stats_json, json_text(plan_json(*plan)));
  if (!a.quiet) put("{}", plan_text(*plan));
}

}  // namespace

Run add_plan_command(CLI::App& app) {
  auto a = std::make_shared<RenderArguments>();
  add_render_options(app, *a);
  app.get_option("--output")->required(false);
  for (const char* refused : {"--deep", "--resume", "--resume-or-begin", "--target-rmse",
                              "--target-error", "--max-spp", "--shutter", "--motion-samples"})
    app.get_option(refused)->group("");  // not in the help; run_plan() says why
  app.footer(
      "Takes the options of dapple render, but for targets, shutters, deep files and --resume, and "
      "writes no image. The figures are for this machine.\n\n"
      "Example:\n  dapple plan tree.glb --spp 512 --width 1920 --height 1080 --shard 1/8");
  return [a] { run_plan(*a); };
}

}  // namespace dapple
