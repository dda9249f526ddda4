// Chooses the reader of a scene by its name. In: a file's path or "scene:..."; out: a Scene.
#include <fmt/format.h>

#include <cmath>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple {

Scene load_scene(const std::string& spec, const SceneOptions& options) {
  if (!(options.light_radius > 0) || !std::isfinite(options.light_radius)) {
    throw Error(ErrorKind::usage,
                fmt::format("--light-radius is {:g}; it must be above 0", options.light_radius));
  }
  return spec.starts_with("scene:") ? make_procedural(spec) : load_gltf(spec, options);
}

}  // namespace dapple
