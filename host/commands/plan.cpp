// dapple plan: what a render would take on this machine. In: the options of dapple render. Out:
// memory, seconds of a shard and bytes of files, from a trial of a thousandth of the samples: a
// smaller image with fewer samples of each pixel.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/option_text.hpp"
#include "commands/progress.hpp"
#include "commands/render_arguments.hpp"
#include "commands/shot.hpp"
#include "commands/statistics_text.hpp"
#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "film/film_memory.hpp"
#include "sampling/shard.hpp"

namespace dapple {
namespace {

/// Part of the samples that a trial has, and the least number of its camera rays: with fewer, the
/// time is that of starting kernels.
constexpr double kShare = 1e-3, kLeastRays = 1 << 16;

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

/// The same view in fewer pixels, and fewer samples of each; footprints stay.
RenderOptions trial_options(const RenderOptions& options, double rays) {
  RenderOptions trial = options;
  trial.shard = {};
  trial.footprint_spp = footprint_samples(options);
  trial.target_error = trial.target_rmse = trial.max_bias = 0;
  const double share = std::min(1.0, std::max(kShare, kLeastRays / rays));
  const double spp = std::max(1.0, std::floor(options.spp * share));
  trial.spp = static_cast<int>(spp);
  const double side = std::sqrt(std::min(1.0, share * options.spp / spp));
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

/// A folder for the trial's files, removed at the end.
class TrialFolder {
 public:
  TrialFolder() {
    const char* set = std::getenv("TMPDIR");
    const std::string parent = set && *set ? set : "/tmp";
    path_ = parent + "/dapple-plan-XXXXXX";
    if (mkdtemp(path_.data())) return;
    throw Error(ErrorKind::failed, fmt::format("cannot make a folder in {}, where TMPDIR says: {}",
                                               parent, std::strerror(errno)));
  }
  ~TrialFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  [[nodiscard]] std::string file(const char* name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// Of the process: the largest so far.
double resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

double file_bytes(const std::string& path) {
  return static_cast<double>(std::filesystem::file_size(path));
}

Plan plan_of(const RenderArguments& a, const RenderOptions& options, Scene scene) {
  Plan plan;
  plan.pixels = pixels_of(options);
  plan.rays = plan.pixels * options.spp;
  plan.shards = options.shard.count;
  plan.shard_rays = plan.pixels * std::ceil(double{1} * options.spp / plan.shards);
  if (!a.frames.empty()) plan.frames = static_cast<double>(parse_frames(a.frames).count());
  const RenderOptions trial = trial_options(options, plan.rays);
  plan.trial_rays = pixels_of(trial) * trial.spp;

  const TrialFolder folder;
  RenderControl control;
  ProgressBar progress(a.quiet, "trial");
  control.progress = progress.callback();
  control.part = folder.file("trial.dapple");
  const std::size_t lights = options.light ? std::max<std::size_t>(2, scene.lights.size()) : 0;
  const RenderResult result = render(std::move(scene), trial, control);
  progress.clear();
  const auto& s = result.statistics.seconds;
  plan.device = result.statistics.device;
  plan.trial_seconds = s.trace;
  plan.before_seconds = s.total - s.trace;
  plan.ray_seconds = s.trace * plan.shard_rays / plan.trial_rays;
  const double more_pixels = plan.pixels - pixels_of(trial);
  plan.memory_bytes =
      resident_bytes() + more_pixels * static_cast<double>(film_bytes_per_pixel(lights, options));
  const std::string image = folder.file("trial.exr");
  write_exr(result.film, image, to_format(a));
  plan.image_bytes = file_bytes(image) * plan.pixels / pixels_of(trial);
  plan.part_bytes = file_bytes(control.part) * plan.pixels / pixels_of(trial);
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

void run_plan(RenderArguments a) {
  if (a.output.empty()) a.output = a.shard.empty() ? "image.exr" : "part.dapple";
  RenderOptions options = to_options(a);
  if (is_adaptive(options))
    throw Error(ErrorKind::usage,
                "dapple plan needs --spp: with a target nobody knows the samples beforehand");
  if (!a.shutter.empty() || options.motion)
    throw Error(ErrorKind::usage,
                "dapple plan knows no moving scenes: leave --shutter and --passes motion out");
  catch_interruptions();
  std::optional<double> seconds = a.frame;
  if (!a.frames.empty())
    seconds = static_cast<double>(parse_frames(a.frames).first) / frames_per_second(a);
  Shot shot(a, options);
  const Plan plan = plan_of(a, options, shot.frame(seconds));
  if (!a.stats_json.empty()) write_whole_file(a.stats_json, plan_json(plan).dump(2) + "\n");
  fmt::print("{}", plan_text(plan));
}

}  // namespace

Run add_plan_command(CLI::App& app) {
  auto a = std::make_shared<RenderArguments>();
  add_render_options(app, *a);
  app.get_option("--output")->required(false);
  app.footer(
      "Takes the options of dapple render, and writes no image. The figures are for this "
      "machine.\n\n"
      "Example:\n  dapple plan tree.glb --spp 512 --width 1920 --height 1080 --shard 1/8");
  return [a] { run_plan(*a); };
}

}  // namespace dapple
