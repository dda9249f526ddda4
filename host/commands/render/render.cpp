// dapple render: reads a scene, renders each frame and writes its files.
#include "dapple/render.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "commands/arguments/option_text.hpp"
#include "commands/command.hpp"
#include "commands/interruption.hpp"
#include "commands/progress.hpp"
#include "commands/render/frames.hpp"
#include "commands/render/render_arguments.hpp"
#include "commands/render/render_values.hpp"
#include "commands/render/shot.hpp"
#include "commands/statistics_text.hpp"
#include "commands/tell.hpp"
#include "dapple/error.hpp"
#include "film/exr/exr_output.hpp"
#include "film/exr/exr_parts.hpp"
#include "film/preview/tone_map.hpp"
#include "render/stopwatch.hpp"

namespace dapple {
namespace {

/// The checkpoint that the render goes on from, if there is one.
std::string resumed_file(const RenderArguments& a) {
  std::error_code unknown;  // reading it tells
  const bool is_there = std::filesystem::exists(a.resume_or_begin, unknown) || unknown;
  return is_there && !a.resume_or_begin.empty() ? a.resume_or_begin : a.resume;
}

RenderControl to_control(const RenderArguments& a, ProgressBar& progress) {
  const std::string resumed = resumed_file(a);
  RenderControl control{progress.callback(), save_when_interrupted(), a.checkpoint,
                        parse_seconds("--checkpoint-every", a.checkpoint_every), resumed};
  control.skip_film = is_late;
  control.warn = warn_of_checkpoint;
  if (!a.checkpoint.empty()) control.progress = end_early(a.checkpoint, resumed, control.progress);
  return control;
}

/// Whether the checkpoint does not fit, and the render may begin anew.
bool may_begin_anew(const Error& error, const RenderArguments& a) {
  return !a.resume_or_begin.empty() && std::string_view(error.what()).starts_with("--resume ");
}

/// `file`.unfit, with a number if there is such a file.
std::string name_aside(const std::string& file) {
  std::string name = file + ".unfit";
  for (int number = 2; std::filesystem::exists(std::filesystem::symlink_status(name)); ++number)
    name = fmt::format("{}.unfit_{}", file, number);
  return name;
}

/// What was written although the checkpoint was not.
const char* written_text(const Frame& frame, bool interrupted) {
  if (!interrupted)
    return is_part_path(frame.output) ? "the part is written" : "the image is written";
  return is_part_path(frame.output) ? "the render was interrupted, and no part is written"
                                    : "the render was interrupted, and the image is written with "
                                      "the samples that it has";
}

/// Says that the render begins anew, and moves a checkpoint aside that its own would replace.
void set_checkpoint_aside(const Error& error, const RenderArguments& a) {
  std::string kept;
  const std::filesystem::path resumed = std::filesystem::weakly_canonical(a.resume_or_begin);
  if (!a.checkpoint.empty() && std::filesystem::weakly_canonical(a.checkpoint) == resumed) {
    const std::string aside = name_aside(a.resume_or_begin);
    std::error_code failure;
    if (std::filesystem::is_symlink(a.checkpoint))  // it must lead somewhere to be written
      std::filesystem::copy_file(resumed, aside, failure);
    else
      std::filesystem::rename(resumed, aside, failure);
    if (failure)
      throw Error(ErrorKind::failed,
                  fmt::format("--resume-or-begin {}: does not fit, and cannot be kept as {}: {}",
                              a.resume_or_begin, aside, failure.message()));
    kept = ", keeps the checkpoint as " + aside;
  }
  tell("note: begins anew{}, since {}\n", kept, error.what());
}

/// Notes of the result also tell names of layers that are not there.
void write_pictures(RenderResult& result, const Frame& frame, const ExrFormat& format,
                    const PngOptions& png) {
  ExrFormat used = format;
  // To end soon: compression takes longer than all else.
  if (result.interrupted) used.compression = ExrCompression::none;
  if (!is_part_path(frame.output))
    write_exr(result.film, frame.output, used, result.interrupted ? Durable::no : Durable::yes);
  if (!frame.deep.empty()) write_deep_exr(result.film, frame.deep);
  if (!frame.png.empty()) write_png(result.film, frame.png, "", png);
  if (!frame.visits_png.empty()) write_heat_map(result.film, frame.visits_png, "visits.nodes");
  for (const std::string& name : half_layers_without_planes(result.film, format))
    result.statistics.notes.push_back(fmt::format("--half {}: there is no such layer", name));
}

/// Prints one line for each note, at most twenty, and none that an earlier frame printed.
class NotePrinter {
 public:
  void print(const std::vector<std::string>& notes) {
    constexpr std::size_t kMax = 20;
    std::size_t printed = 0, left = 0;
    for (const std::string& note : notes) {
      if (!told_.insert(note).second) continue;
      if (printed++ < kMax) {
        tell("note: {}\n", note);
      } else {
        ++left;
      }
    }
    if (left > 0) tell("note: and {} more\n", left);
  }

 private:
  std::set<std::string> told_;
};

/// The files that were written; of an interrupted part there is none.
std::string files_text(const Frame& frame, bool interrupted) {
  std::vector<std::string> files;
  if (!interrupted || !is_part_path(frame.output)) files.push_back(frame.output);
  for (const std::string& beside : {frame.png, frame.visits_png, frame.deep})
    if (!beside.empty()) files.push_back(beside);
  if (files.empty()) return "nothing";
  const std::string last = files.back();
  files.pop_back();
  return files.empty() ? last : fmt::format("{} and {}", fmt::join(files, ", "), last);
}

/// `exposure`: of the preview, stops. Its digits make the same preview again.
void print_summary(const RenderStatistics& s, const Frame& frame, std::optional<float> exposure,
                   bool interrupted) {
  const std::string files = files_text(frame, interrupted);
  const bool is_shown = exposure && !frame.png.empty();
  const std::string stops = is_shown ? fmt::format("; --exposure {}", *exposure) : "";
  if (frame.title.empty()) {
    put("{}wrote {}{}\n", statistics_text(s), files, stops);
    return;
  }
  put("{}, at {:.3f} s: load {:.2f}, build {:.2f}, refit {:.2f}, trace {:.2f}, total {:.2f} s; "
      "wrote {}{}\n",
      frame.title, *frame.seconds, s.seconds.load, s.seconds.build + s.seconds.prefilter,
      s.seconds.refit, s.seconds.trace, s.seconds.total, files, stops);
  put_now();
}

/// Of a render that had no time for its picture.
void report_saved(RenderStatistics& s, const Frame& frame, double total_seconds) {
  s.seconds.total = total_seconds;
  if (!frame.stats_json.empty()) write_statistics(s, frame.stats_json);
  if (is_part_path(frame.output)) return;
  s.notes.push_back(
      fmt::format("not written, to end soon: {}; the checkpoint has all", files_text(frame, true)));
}

std::optional<double> first_seconds(const RenderArguments& a, const Frame& frame) {
  if (!frame.seconds) return {};
  return shutter_seconds(a, *frame.seconds, 0);
}

/// `first`: the scene when the shutter opens.
RenderResult render_frame(const RenderArguments& a, const Frame& frame, Shot& shot, Scene first,
                          Renderer& renderer, const RenderOptions& options,
                          const RenderControl& control) {
  if (a.shutter.empty() && !options.motion)
    return renderer.render(std::move(first), options, control);
  if (!frame.seconds)
    throw Error(ErrorKind::usage, "--passes motion needs --frame or --frames: which time to show");
  const auto scene_at = [&](int k) { return shot.frame(shutter_seconds(a, *frame.seconds, k)); };
  const auto next_at = [&](int k) {
    return shot.frame(shutter_seconds(a, *frame.seconds, k) + 1 / frames_per_second(a));
  };
  const int times = shutter_times(a);
  RenderResult result = renderer.render_shutter(scene_at, times, options, control, next_at);
  if (a.shutter.empty()) return result;
  result.film.metadata.settings.emplace_back("shutter", a.shutter);
  result.film.metadata.settings.emplace_back("motion_samples", fmt::format("{}", times));
  return result;
}

bool has_positive(const Plane& plane) {
  return std::any_of(plane.pixels.begin(), plane.pixels.end(), [](float v) { return v > 0; });
}

/// Whether a layer is of the other sides of surfaces: that of their fronts is there, too. A light
/// may be named "back".
bool is_of_backs(const Film& film, const std::string& layer) {
  constexpr std::string_view kBack = ".back";
  return layer.ends_with(kBack) &&
         film.find(layer.substr(0, layer.size() - kBack.size()) + ".R") != nullptr;
}

/// Whether something is seen, and lit by a light from the front, if there are lights.
bool is_lit(const Film& film) {
  if (!has_positive(*film.find("A"))) return false;
  bool has_lights = false;
  for (const Plane& plane : film.planes) {
    if (!plane.channel.starts_with("light.") || is_of_backs(film, layer_of(plane.channel)))
      continue;
    if (has_positive(plane)) return true;
    has_lights = true;
  }
  return !has_lights;
}

/// What the later frames of a sequence take over from this one.
void keep_choices(const RenderResult& result, bool has_dome, bool writes_png,
                  RenderOptions& options, PngOptions& png) {
  // They have the exposure and the sky of the first frame that is lit.
  const bool lit = is_lit(result.film);
  if (lit && !png.exposure && writes_png)
    png.exposure = std::clamp(std::log2(automatic_exposure(result.film)), -100.0f, 100.0f);
  // A dome is the sky, whether the frame shows light or not.
  if ((lit || has_dome) && !options.ambient)
    options.ambient = static_cast<float>(result.statistics.ambient);
  if (!has_positive(*result.film.find("A"))) return;
  // A frame that shows nothing has no bias to choose a footprint by.
  options.footprint = result.statistics.footprint;
  options.keep_footprint = true;
}

std::vector<std::pair<std::string, std::string>> settings_of(const Shot& shot, const Frame& frame) {
  std::vector<std::pair<std::string, std::string>> settings = shot.settings();
  if (frame.seconds) settings.emplace_back("frame_seconds", fmt::format("{}", *frame.seconds));
  return settings;
}

/// The parts of a command that its frames share.
class RenderRun {
 public:
  explicit RenderRun(const RenderArguments& a)
      : a_(a),
        options_(to_options(a)),
        format_(to_format(a)),
        png_(parse_png_options(a.exposure, a.background)),
        progress_(a.quiet, "rendering"),
        control_(to_control(a, progress_)) {}

  void run() {
    const std::vector<Frame> frames = list_frames(a_);
    check_files(frames, a_);
    if (!options_.cache.empty()) prepare_bvh_cache(options_.cache);
    catch_interruptions();
    if (!a_.resume_or_begin.empty() && control_.resume.empty() && !a_.quiet)
      tell("note: begins anew, since {} is not there\n", a_.resume_or_begin);
    use_exr_threads(static_cast<int>(std::thread::hardware_concurrency()));

    Stopwatch total;
    renderer_.prepare(options_);
    progress_.announce("reading", a_.dome.empty() ? a_.scene : a_.dome);
    Shot shot(a_, options_);
    progress_.announce("reading", a_.scene);
    for (const Frame& frame : frames) {
      progress_.begin(frame.title);
      Scene scene = shot.frame(first_seconds(a_, frame));
      if (&frame == &frames.front()) {
        check_files_spare(frames, a_, scene.files);
        progress_.announce("building", "the BVH");
      }
      const double load_seconds = total.seconds();
      RenderResult result = trace(frame, shot, std::move(scene));
      result.statistics.seconds.load = load_seconds;
      if (!write(frame, result, total)) break;
      total = Stopwatch();
    }
  }

 private:
  RenderResult trace(const Frame& frame, Shot& shot, Scene scene) {
    control_.part = is_part_path(frame.output) ? frame.output : "";
    control_.settings = settings_of(shot, frame);
    if (a_.animate_seed) options_.seed = a_.options.seed + static_cast<std::uint32_t>(frame.number);
    RenderResult result;
    try {
      result = render_frame(a_, frame, shot, std::move(scene), renderer_, options_, control_);
    } catch (const Error& error) {
      if (!may_begin_anew(error, a_)) throw;
      set_checkpoint_aside(error, a_);
      control_.resume.clear();
      result = render_frame(a_, frame, shot, shot.frame(first_seconds(a_, frame)), renderer_,
                            options_, control_);
    }
    slices_are_traced();
    progress_.clear();
    return result;
  }

  /// `total`: since the frame began. False: interrupted, no frames follow.
  bool write(const Frame& frame, RenderResult& result, const Stopwatch& total) {
    RenderStatistics& statistics = result.statistics;
    // Interrupted before this frame began: the previous frame was the last.
    if (result.interrupted && !frame.title.empty() && statistics.rays.camera == 0) return false;
    if (result.film.planes.empty()) {
      report_saved(statistics, frame, total.seconds());
      if (!a_.quiet) notes_.print(statistics.notes);
      return false;
    }
    const Stopwatch writing;
    keep_choices(result, !a_.dome.empty(), !frame.png.empty(), options_, png_);
    write_pictures(result, frame, format_, png_);
    statistics.seconds.write = writing.seconds();
    statistics.seconds.total = total.seconds();
    if (!frame.stats_json.empty()) write_statistics(statistics, frame.stats_json);
    if (!result.checkpoint_failure.empty())
      throw Error(ErrorKind::failed, fmt::format("{}; {}", result.checkpoint_failure,
                                                 written_text(frame, result.interrupted)));
    if (!a_.quiet) {
      notes_.print(statistics.notes);
      print_summary(statistics, frame, png_.exposure, result.interrupted);
    }
    return !result.interrupted && interruption_code() == 0;
  }

  const RenderArguments& a_;
  RenderOptions options_;
  const ExrFormat format_;
  PngOptions png_;
  ProgressBar progress_;
  RenderControl control_;
  Renderer renderer_;
  NotePrinter notes_;
};

}  // namespace

Run add_render_command(CLI::App& app) {
  auto a = std::make_shared<RenderArguments>();
  add_render_options(app, *a);
  app.footer(
      "Examples:\n  dapple render tree.glb --opacity leaf=0.85 --spp 64 -o tree.exr --png "
      "tree.png\n"
      "  dapple render tree.glb --spp 1024 -o tree.exr --checkpoint tree.ckpt  # Ctrl-C saves\n"
      "  dapple render tree.glb --spp 1024 -o tree.exr --checkpoint tree.ckpt --resume tree.ckpt\n"
      "  dapple render \"scene:tree?wind=1\" --frames 0-47 --fps 24 -o out.####.exr"
      "\n\n"
      "Layers: R,G,B,A; albedo; beauty.NAME; ao; bent; light.NAME; ao.back, light.NAME.back; N; "
      "Ng; P; Z; "
      "motion; "
      "crypto_object, crypto_material; samples; error; visits. Where rays miss, ao is 1.");
  return [a] { RenderRun(*a).run(); };
}

}  // namespace dapple
