// Chooses the reader of a scene by its name, and checks the options of reading. In: a file's path
// or "scene:..."; out: a Scene.
#include <fmt/format.h>

#include <cmath>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/hair_file.hpp"
#include "scene/unused_options.hpp"

namespace dapple {
namespace {

void check_radius(const char* flag, float radius, const char* otherwise) {
  constexpr float kMin = 1e-6f, kMax = 1e6f;
  if (radius >= kMin && radius <= kMax) return;
  throw Error(ErrorKind::usage, fmt::format("{} is {:g}; it must be {}from {:g} to {:g}", flag,
                                            radius, otherwise, kMin, kMax));
}

}  // namespace

void validate(const SceneOptions& options) {
  check_radius("--light-radius", options.light_radius, "");
  if (options.line_radius != 0) check_radius("--line-radius", options.line_radius, "0 or ");
  if (options.time && !std::isfinite(*options.time))
    throw Error(ErrorKind::usage, "--frame must be a finite number of seconds");
}

Scene load_scene(const std::string& spec, const SceneOptions& options) {
  validate(options);
  if (spec.empty()) throw Error(ErrorKind::input, "the path of the scene is empty");
  const bool is_procedural = spec.starts_with("scene:");
  if (!is_procedural && !is_hair_name(spec)) return load_gltf(spec, options);
  refuse_named_animation(spec, options);
  Scene scene = is_procedural ? make_procedural(spec, options.time) : load_hair(spec);
  if (!is_procedural) add_time_warning(spec, options.time, scene);
  warn_of_no_lines(spec, options, scene);
  return scene;
}

}  // namespace dapple
