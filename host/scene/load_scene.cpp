// Chooses the reader of a scene by its name. In: a file's path or "scene:..."; out: a Scene.
#include <fmt/format.h>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple {

void validate(const SceneOptions& options) {
  constexpr float kLeast = 1e-6f, kMost = 1e6f;
  if (options.light_radius >= kLeast && options.light_radius <= kMost) return;
  throw Error(ErrorKind::usage, fmt::format("--light-radius is {:g}; it must be from {:g} to {:g}",
                                            options.light_radius, kLeast, kMost));
}

Scene load_scene(const std::string& spec, const SceneOptions& options) {
  validate(options);
  return spec.starts_with("scene:") ? make_procedural(spec) : load_gltf(spec, options);
}

}  // namespace dapple
