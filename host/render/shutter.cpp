#include "render/shutter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"
#include "device/upload/light_upload.hpp"
#include "sampling/shard.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/corner_normals.hpp"
#include "scene/lights/dark_light.hpp"

namespace dapple {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorKind::usage, why); }

void check_motion(const Shutter& shutter, const RenderOptions& options) {
  if (!options.motion) return;
  if (!shutter.next_at)
    refuse("motion vectors need the next frame: give --frame or --frames (render_shutter())");
  if (options.ground) refuse("with motion vectors the ground must be part of the scenes");
}

}  // namespace

void check_shutter(const Shutter& shutter, const RenderOptions& options,
                   const RenderControl& control) {
  if (!shutter.scene_at) refuse("render_shutter() needs a function that gives the scenes");
  check_motion(shutter, options);
  if (options.deep && !(control.checkpoint.empty() && control.resume.empty()))
    refuse("--checkpoint and --resume do not go with --deep");
  if (options.deep && !control.part.empty())
    refuse("--deep does not go with --shard and -o FILE.dapple: parts have no depths");
  if (options.max_bias > 0 && !control.part.empty())
    refuse(
        "--max-bias does not go with --shard and -o FILE.dapple: parts would choose footprints by "
        "their own pixels; give --footprint, or neither");
  if (shutter.times == 1) return;
  if (options.ground) refuse("with motion blur the ground must be part of the scenes");
  if (is_adaptive(options))
    refuse("--target-error and --target-rmse do not go with --shutter: give --spp");
  if (!control.checkpoint.empty() || !control.resume.empty())
    refuse("--checkpoint and --resume do not go with --shutter");
  if (!control.part.empty())
    refuse(
        "--shutter does not go with --shard and -o FILE.dapple: the moments of a shutter are of "
        "different scenes; let shards be frames");
  if (shutter.times < 1 || shutter.times > options.spp)
    refuse(fmt::format("--motion-samples is {}; it must be from 1 to --spp ({})", shutter.times,
                       options.spp));
}

std::string uneven_moments_note(int spp, int times) {
  return fmt::format(
      "some of the {0} moments of the shutter have {1} samples a pixel, others {2}, which weigh "
      "more; --spp {3} gives all as many",
      times, spp / times, spp / times + 1, (spp / times + 1) * times);
}

ShutterScenes look_at_moments(const Shutter& shutter) {
  ShutterScenes scenes;
  scenes.count = shutter.times;
  for (int time = 0; shutter.times > 1 && time < shutter.times; ++time) {
    const Scene scene = shutter.scene_at(time);
    check_scene(scene);
    scenes.bounds.extendBy(scene_bounds(scene));
    scenes.smooth = scenes.smooth || is_smooth(scene);
    if (time == 0) scenes.radiance.resize(scene.lights.size(), V3f(0, 0, 0));
    if (scenes.radiance.size() != scene.lights.size()) scenes.radiance.clear();
    std::vector<EmitterTriangle> of_mesh_lights;
    pack_lights(scene, scenes.lights, of_mesh_lights);
    for (std::size_t i = 0; i < scenes.radiance.size(); ++i)
      if (scenes.radiance[i] == V3f(0, 0, 0)) scenes.radiance[i] = scene.lights[i].radiance;
  }
  if (scenes.radiance.empty()) scenes.lights.clear();
  return scenes;
}

void set_lit_radiance(const ShutterScenes& moments, std::vector<Light>& lights) {
  if (moments.radiance.size() != lights.size()) return;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (is_dark(lights[i]) && lights[i].kind != LightKind::dome)
      lights[i].radiance = moments.radiance[i];
}

RenderOptions until(const RenderOptions& options, int time, int times) {
  RenderOptions part = options;
  part.footprint_spp = footprint_samples(options);
  const auto end = static_cast<int>(rays_of(options.shard, options.spp).end);
  part.spp = std::min(end, static_cast<int>(std::int64_t{options.spp} * (time + 1) / times));
  return by_sample(part);
}

Progress part_of(const Progress& progress, int time, int times) {
  if (!progress) return {};
  return [=](double fraction) { progress(fraction * time / times); };
}

void check_same_lights(const std::vector<Light>& first, const std::vector<Light>& now) {
  const bool same = std::equal(first.begin(), first.end(), now.begin(), now.end(),
                               [](const Light& a, const Light& b) { return a.kind == b.kind; });
  if (!same) throw Error(ErrorKind::input, "lights come or go while the shutter is open");
}

void check_same_objects(const Scene& first, const Scene& now) {
  if (first.objects != now.objects)
    throw Error(ErrorKind::input, "objects come or go while the shutter is open");
}

}  // namespace dapple
