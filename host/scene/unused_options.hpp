// Options of reading that change nothing in a scene. In: the scene's name and the options; out: an
// Error, or a warning in the scene. The readers of all kinds of scenes say the same.
#pragma once

#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// For scenes that are not glTF files: throws Error usage if an animation is chosen by name. "*"
/// stands for all animations, and there may be none.
void refuse_named_animation(const std::string& spec, const SceneOptions& options);

/// Warns that a scene is the same at all times.
void warn_of_rest(const std::string& spec, Scene& scene);

/// Warns, if lines have a radius, that a scene has no lines.
void warn_of_no_lines(const std::string& spec, const SceneOptions& options, Scene& scene);

}  // namespace dapple
