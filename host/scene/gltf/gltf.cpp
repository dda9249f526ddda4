// Makes a Scene from a glTF file, at rest or at a time. In: a path, options and a time; out: a
// Scene. Each step is a file of this folder; only this folder uses tinygltf.
#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <utility>

#include "dapple/scene.hpp"
#include "scene/gltf/camera.hpp"
#include "scene/gltf/crowding.hpp"
#include "scene/gltf/instance.hpp"
#include "scene/gltf/light.hpp"
#include "scene/gltf/moving_gltf.hpp"
#include "scene/gltf/pose/hierarchy.hpp"
#include "scene/gltf/topology.hpp"
#include "scene/message.hpp"
#include "scene/unused_options.hpp"

namespace dapple {
namespace {

template <typename Work>
auto within_memory(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::failed, path + ": there is not enough memory to read it");
  }
}

bool has_any_lines(const tinygltf::Model& model) {
  return std::any_of(model.meshes.begin(), model.meshes.end(), gltf::has_lines);
}

void warn_of_other_scenes(const tinygltf::Model& model, Scene& scene) {
  if (model.scenes.size() < 2) return;
  const auto shown = static_cast<std::size_t>(std::max(model.defaultScene, 0));
  scene.warnings.push_back(one_line(
      fmt::format("{}: of its {} scenes only {} is read", scene.source, model.scenes.size(),
                  element("scene", shown, model.scenes[shown].name))));
}

/// glTF says of no animation that it plays before others.
void warn_of_other_animations(const SceneOptions& options, Scene& scene) {
  if (scene.animations.size() < 2 || !options.animation.empty()) return;
  scene.warnings.push_back(one_line(fmt::format(
      "{}: of its {} animations only {} plays; --animation \"*\" plays all", scene.source,
      scene.animations.size(), element("animation", 0, scene.animations.front().name))));
}

}  // namespace

namespace gltf {

MovingGltf::MovingGltf(const std::string& path, const SceneOptions& options, bool plays)
    : options_(options), document_(load_document(path, options.allow_outside)) {
  if (plays) player_.emplace(document_, options.animation);
  timeless_.source = path;
  timeless_.files = document_.files;
  for (const std::string& note : document_.notes)
    timeless_.warnings.push_back(one_line(path + ": " + note));
  warn_of_other_scenes(document_.model, timeless_);
  if (!has_any_lines(document_.model)) warn_of_no_lines(path, options, timeless_);
  timeless_.animations = list_animations(document_);
  if (plays) warn_of_other_animations(options, timeless_);
  for (const auto& node : document_.model.nodes)
    timeless_.node_names.push_back(node.mesh >= 0 ? one_line(node.name) : "");
  // The needed materials and images do not depend on the pose.
  materials_ = read_materials(document_, place_nodes(document_), options.line_radius > 0,
                              options.colors, timeless_);
}

Scene MovingGltf::at(std::optional<double> seconds) const {
  const Pose pose = seconds && player_ ? player_->at(*seconds) : Pose{};
  const std::vector<PlacedNode> placed = place_nodes(document_, pose);
  Scene scene = timeless_;
  add_instances(document_, placed, materials_, pose, options_, scene);
  check_crowding(scene);
  add_punctual_lights(document_, placed, options_, scene);
  add_cameras(document_, placed, scene);
  if (seconds && document_.motion.clips.empty()) warn_of_rest(document_.file, scene);
  return scene;
}

}  // namespace gltf

Scene load_gltf(const std::string& path, const SceneOptions& options) {
  validate(options);
  const bool plays = options.time || !options.animation.empty();
  return within_memory(path,
                       [&] { return gltf::MovingGltf(path, options, plays).at(options.time); });
}

}  // namespace dapple
