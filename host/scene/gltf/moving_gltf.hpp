// A glTF file that is read once and posed for many times. In: a path and options, then times in
// seconds; out: a Scene for each time.
#pragma once

#include <optional>
#include <string>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/pose/animation.hpp"

namespace dapple::gltf {

class MovingGltf {
 public:
  /// With `plays`, at() may be called with times, and animations are checked here. Throws Error
  /// input, and Error usage when the animation of the options does not exist.
  MovingGltf(const std::string& path, const SceneOptions& options, bool plays);
  // Not copied: player_ has a reference to document_.
  MovingGltf(const MovingGltf&) = delete;
  MovingGltf& operator=(const MovingGltf&) = delete;

  /// Returns the scene at a time; none: at rest. Throws Error input when the pose or the scene is
  /// invalid.
  [[nodiscard]] Scene at(std::optional<double> seconds) const;

 private:
  SceneOptions options_;
  Document document_;
  std::optional<Player> player_;
  Scene timeless_;  ///< the part that does not depend on the time: materials and textures
  MaterialSet materials_;
};

}  // namespace dapple::gltf
