// Chooses the reader of a scene by its name. In: a file's path or "scene:..."; out: a Scene.
#include "dapple/scene.hpp"

namespace dapple {

Scene load_scene(const std::string& spec, const SceneOptions& options) {
  return spec.starts_with("scene:") ? make_procedural(spec) : load_gltf(spec, options);
}

}  // namespace dapple
