#include "commands/render/render_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "commands/arguments/option_text.hpp"
#include "commands/arguments/output_name.hpp"
#include "commands/arguments/shared_options.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

void check_animation(const RenderArguments& a) {
  if (!a.scene_options.animation.empty() && !a.frame && a.frames.empty())
    throw Error(ErrorKind::usage, "--animation needs --frame or --frames: which time to show");
}

bool wants_motion(const RenderArguments& a) {
  RenderOptions passes;
  parse_passes(a.passes, passes);
  return passes.motion;
}

void check_motion(const RenderArguments& a) {
  const double fps = frames_per_second(a);
  if (!(std::isfinite(fps) && fps > 0))
    throw Error(ErrorKind::usage, "--fps must be a number above 0");
  if (a.fps && a.frames.empty() && !a.frame && a.shutter.empty() && !wants_motion(a))
    throw Error(ErrorKind::usage, "--fps needs --frame, --frames, --shutter or --passes motion");
  if (a.shutter.empty()) return check_animation(a);
  if (!a.frame && a.frames.empty())
    throw Error(ErrorKind::usage, "--shutter needs --frame or --frames: when it opens");
  const auto [open, close] = parse_shutter(a.shutter);
  if (!(close > open))
    throw Error(ErrorKind::usage,
                fmt::format("--shutter {}: it must close after it opens", a.shutter));
  if (a.motion_samples && (*a.motion_samples < 1 || *a.motion_samples > 1024))
    throw Error(ErrorKind::usage, fmt::format("--motion-samples is {}; it must be from 1 to 1024",
                                              *a.motion_samples));
  check_animation(a);
}

/// A part is for dapple merge, which makes the image.
void check_part(const RenderArguments& a, const RenderOptions& options) {
  const auto refuse = [](const std::string& why) { throw Error(ErrorKind::usage, why); };
  if (!is_part_path(a.output)) {
    if (options.shard.count > 1)
      refuse("--shard " + a.shard + " makes a part of an image, for dapple merge: -o FILE.dapple");
    return;
  }
  if (is_adaptive(options)) {
    refuse(fmt::format("-o {}: a part has a fixed number of samples: give --spp in place of {}",
                       a.output, options.target_rmse > 0 ? "--target-rmse" : "--target-error"));
  }
  if (!a.half.empty() || a.multipart || a.compression != RenderArguments().compression)
    refuse("-o " + a.output +
           ": --half, --multipart and --compression are for the image: give them to dapple merge");
  const bool is_part_of_frames = options.shard.count > 1 || (options.crop && a.dome.empty());
  if (is_part_of_frames && !a.frames.empty() && options.light && !options.ambient)
    refuse(fmt::format(
        "{} with --frames needs --ambient: without it the sky of all frames is chosen from the {} "
        "of the first, and {} would choose differently",
        options.shard.count > 1 ? "--shard" : "-o FILE.dapple and --crop",
        options.shard.count > 1 ? "samples" : "pixels",
        options.shard.count > 1 ? "shards" : "crops"));
}

/// A layer that pictures have, or all below one: "light", "light.sun".
void check_half_layer(const std::string& name) {
  static const std::vector<std::string> kLayers{
      "all", "RGBA", "albedo", "beauty", "ao", "bent", "light", "N", "Ng", "error", "visits"};
  for (const std::string& layer : kLayers)
    if (name == layer || name.starts_with(layer + ".")) return;
  throw Error(ErrorKind::usage, fmt::format("--half {}: there is no such layer; there are {}", name,
                                            fmt::join(kLayers, ", ")));
}

/// Options that would change nothing, as if they were misspelt.
void check_effects(const RenderArguments& a, const RenderOptions& o) {
  const RenderOptions defaults;
  const auto need = [](bool given, const char* flag, bool has_effect, const char* what) {
    if (given && !has_effect) throw Error(ErrorKind::usage, fmt::format("{} needs {}", flag, what));
  };
  need(o.back_every != defaults.back_every, "--back-every", o.back,
       "the pass back: --passes ao,light,albedo,back");
  need(is_adaptive(o), "--target-rmse and --target-error", o.ao || o.light,
       "the pass ao, light or beauty");
  need(o.ao_rays != defaults.ao_rays, "--ao-rays", o.ao, "the pass ao");
  need(o.light_rays != defaults.light_rays, "--light-rays", o.light, "the pass light or beauty");
  need(!a.lights.empty(), "--lights", o.light, "the pass light or beauty");
  need(!a.dome.empty(), "--dome", o.light, "the pass light or beauty");
  need(o.ao_distance > 0, "--ao-distance", o.ao, "the pass ao");
  need(o.roulette != defaults.roulette, "--roulette", o.estimator == Estimator::exact,
       "--estimator exact");
  need(o.max_spp != defaults.max_spp, "--max-spp", is_adaptive(o),
       "--target-rmse or --target-error");
  need(a.animate_seed, "--animate-seed", !a.frames.empty(), "--frames");
  need(a.dome_rotation != 0, "--dome-rotation", !a.dome.empty(), "--dome");
}

}  // namespace

void check_png(const RenderArguments& a) {
  parse_png_options(a.exposure, a.background);
  check_png_name(a.png);
  if (!a.png.empty()) return;
  const RenderArguments defaults;
  for (const char* flag : {a.exposure != defaults.exposure ? "--exposure" : "",
                           a.background != defaults.background ? "--background" : ""})
    if (*flag)
      throw Error(ErrorKind::usage, fmt::format("{} needs --png: it changes no EXR", flag));
}

bool is_part_path(const std::string& path) { return path.ends_with(".dapple"); }

double frames_per_second(const RenderArguments& a) { return a.fps.value_or(24); }

int shutter_times(const RenderArguments& a) {
  constexpr int kMost = 8, kFewest = 4;
  if (a.shutter.empty()) return 1;
  if (a.motion_samples) return *a.motion_samples;
  // As many samples for each moment, if that is possible.
  const int spp = a.spp.value_or(a.options.spp);
  for (int times = kMost; times >= kFewest; --times)
    if (spp % times == 0) return times;
  return std::min(kMost, spp);
}

double shutter_seconds(const RenderArguments& a, double seconds, int k) {
  if (a.shutter.empty()) return seconds;
  const auto [open, close] = parse_shutter(a.shutter);
  return seconds + (open + (close - open) * (k + 0.5) / shutter_times(a)) / frames_per_second(a);
}

ExrFormat to_format(const RenderArguments& a) {
  ExrFormat format;
  format.half = parse_names("--half", a.half);
  format.multipart = a.multipart;
  format.compression = parse_compression(a.compression);
  validate(format);
  for (const std::string& name : format.half) check_half_layer(name);
  return format;
}

RenderOptions to_options(const RenderArguments& a) {
  RenderOptions o = a.options;
  if (a.spp) o.spp = *a.spp;
  if (!a.spp && o.target_rmse > 0) o.spp = 1;
  if (a.fov) o.fov_degrees = *a.fov;
  if (a.fov && *a.fov == 0)  // in RenderOptions it means the camera's own
    throw Error(ErrorKind::usage, "--fov is 0; it must be from 0.01 to 179");
  // Frames that are rendered one by one must be alike.
  if ((a.footprint_given || a.frame) && !o.max_bias) o.max_bias = 0.0f;
  o.estimator = parse_estimator(a.estimator);
  o.normals = parse_normals(a.normals);
  o.report_bias = parse_share("--report-bias", a.report_bias);
  o.packets = parse_packets(a.packets);
  parse_passes(a.passes, o);
  o.cryptomattes = parse_cryptomattes(a.cryptomatte);
  o.deep = !a.deep.empty();
  if (!a.crop.empty()) o.crop = parse_crop(a.crop);
  if (!a.look_from.empty() || !a.look_at.empty()) {
    if (a.look_from.empty() || a.look_at.empty()) {
      throw Error(ErrorKind::usage, "--look-from and --look-at go together");
    }
    const V3f from = parse_vector("--look-from", a.look_from),
              at = parse_vector("--look-at", a.look_at);
    const bool is_vertical = from.x == at.x && from.z == at.z;
    const V3f up = is_vertical ? V3f(0, 0, -1) : V3f(0, 1, 0);
    o.look = LookAt{from, at, a.up.empty() ? up : parse_vector("--up", a.up)};
  }
  if (!a.shard.empty()) o.shard = parse_shard(a.shard);
  if (!a.up.empty()) parse_vector("--up", a.up);
  check_png(a);
  check_effects(a, o);
  dome_rotation("--dome-rotation", a.dome_rotation);
  for (const std::string& text : a.opacity) o.opacity.push_back(parse_opacity(text));
  validate(o);
  check_exr_name("--output", a.output);
  check_exr_name("--deep", a.deep);
  check_part(a, o);
  check_motion(a);
  return o;
}

}  // namespace dapple
