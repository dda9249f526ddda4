// The scene of each frame: see shot.hpp.
#include "commands/render/shot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "camera/view.hpp"
#include "commands/arguments/shared_options.hpp"
#include "dapple/error.hpp"
#include "film/opacity_settings.hpp"
#include "scene/check/invertible.hpp"
#include "scene/ground.hpp"
#include "scene/lights/default_lights.hpp"

namespace dapple {
namespace {

Light read_dome(const RenderArguments& a) {
  Light dome = dome_light("dome", a.dome);
  dome.rotation = dome_rotation("--dome-rotation", a.dome_rotation);
  return dome;
}

/// The options that choose a camera again that was added to a scene. `has_focus`: the options have
/// its focus distance; else the camera would focus on the point that it looks at.
std::string camera_options(const Camera& camera, bool has_focus) {
  const V3f from = camera.to_world.translation();
  V3f forward;
  camera.to_world.multDirMatrix(V3f(0, 0, -1), forward);
  // As far away as the origin is: coordinates have few digits there.
  const V3f at = from + forward * std::max(1.0f, from.length());
  const std::string focus = camera.lens_radius > 0 && !has_focus
                                ? fmt::format(" --focus-distance {}", camera.focus_distance)
                                : "";
  return fmt::format(
      "--look-from {:.9g},{:.9g},{:.9g} --look-at {:.9g},{:.9g},{:.9g} --fov {:.9g}{}", from.x,
      from.y, from.z, at.x, at.y, at.z, camera.fov_y * 180 / std::numbers::pi_v<float>, focus);
}

/// How other frames have the ground that was put under one, or under the first of a sequence.
std::string ground_note(const Box3f& under, bool is_sequence) {
  const float height = ground_height(under);
  return is_sequence ? fmt::format(
                           "all frames have the same ground; a later sequence has it with "
                           "--ground --ground-height={}",
                           height)
                     : fmt::format(
                           "the ground lies under what this frame shows; other frames have it with "
                           "--ground --ground-height={}",
                           height);
}

/// Whether everything is scaled to nothing.
bool is_empty(const Scene& scene) {
  return std::none_of(scene.instances.begin(), scene.instances.end(),
                      [](const Instance& instance) { return is_invertible(instance.to_world); });
}

/// Colours are read only where they are shown.
SceneOptions scene_options_of(const RenderArguments& a, const RenderOptions& options) {
  SceneOptions scene_options = a.scene_options;
  scene_options.colors = options.albedo;
  return scene_options;
}

}  // namespace

Shot::Shot(const RenderArguments& a, RenderOptions& options) : arguments_(a), options_(options) {
  if (!a.lights.empty()) lights_ = load_lights(a.lights);
  if (!a.dome.empty()) dome_ = read_dome(a);
  if (lights_ && lights_->empty() && !dome_)
    options.light = options_.light = false;  // else default lights would be added
  if (a.frames.empty() && a.shutter.empty() && !options.motion) return;
  moving_.emplace(a.scene, scene_options_of(a, options));
  options.ground = false;
  options.ground_height.reset();
  options.opacity.clear();
}

std::vector<std::pair<std::string, std::string>> Shot::settings() const {
  if (!moving_) return {};  // the renderer applies the opacities, and names them
  return opacity_settings(options_.opacity);
}

Scene Shot::frame(std::optional<double> seconds) {
  SceneOptions scene_options = scene_options_of(arguments_, options_);
  scene_options.time = seconds;
  Scene scene = moving_ ? moving_->at(seconds) : load_scene(arguments_.scene, scene_options);
  if (lights_) use_lights(scene, *lights_);
  if (dome_) scene.lights.push_back(*dome_);
  if (!moving_) {
    if (seconds && options_.ground && !options_.ground_height)
      scene.warnings.push_back(ground_note(bounds_to_stand_on(scene), false));
    return scene;
  }
  // Before the ground is added, as in a still: its material is not the scene's.
  for (const auto& [material, value] : options_.opacity) override_opacity(scene, material, value);
  if (!defaults_) defaults_ = choose_defaults(scene, is_empty(scene) ? at_its_end(scene) : scene);
  add_defaults(scene);
  return scene;
}

// What grows from nothing is seen best when it is grown.
Scene Shot::at_its_end(const Scene& first) const {
  double seconds = 0;
  for (const Animation& animation : first.animations)
    seconds = std::max(seconds, animation.seconds);
  Scene scene = moving_->at(seconds);
  scene.cameras = first.cameras;
  return scene;
}

Shot::Defaults Shot::choose_defaults(const Scene& first, const Scene& shown) const {
  Defaults chosen;
  const Camera camera = choose_view(shown, options_, chosen.notes).camera;
  if (!options_.look && first.cameras.empty()) {
    chosen.camera = camera;
    if (!arguments_.frames.empty())
      chosen.notes.push_back("all frames have the same camera; a later sequence has it with " +
                             camera_options(camera, options_.focus_distance.has_value()));
  }
  if (!options_.look) chosen.camera_name = camera.name;
  chosen.focus_distance = camera.focus_distance;
  if (options_.light && first.lights.empty()) chosen.lights = daylight(camera);
  if (!options_.ground) return chosen;
  chosen.ground_under = bounds_to_stand_on(shown);
  if (!options_.ground_height)
    chosen.notes.push_back(ground_note(*chosen.ground_under, !arguments_.frames.empty()));
  return chosen;
}

// A camera that is scaled to nothing at some moments is not in the scene then.
void Shot::keep_camera(Scene& scene) const {
  if (options_.look) return;
  if (defaults_->camera) {
    scene.cameras = {*defaults_->camera};
    return;
  }
  const auto kept =
      std::find_if(scene.cameras.begin(), scene.cameras.end(),
                   [&](const Camera& camera) { return camera.name == defaults_->camera_name; });
  if (kept == scene.cameras.end())
    throw Error(ErrorKind::input,
                fmt::format("{}: camera {} is scaled to nothing at some moments; --look-from and "
                            "--look-at choose another",
                            arguments_.scene, defaults_->camera_name));
  std::iter_swap(scene.cameras.begin(), kept);
  Camera& camera = scene.cameras.front();
  if (camera.focus_distance == 0) camera.focus_distance = defaults_->focus_distance;
}

void Shot::add_defaults(Scene& scene) const {
  keep_camera(scene);
  scene.lights.insert(scene.lights.end(), defaults_->lights.begin(), defaults_->lights.end());
  if (defaults_->ground_under) add_ground(scene, *defaults_->ground_under, options_.ground_height);
  scene.warnings.insert(scene.warnings.end(), defaults_->notes.begin(), defaults_->notes.end());
  if (!defaults_->lights.empty())
    scene.warnings.push_back(default_light_note(defaults_->ground_under.has_value()));
}

}  // namespace dapple
