// A glTF file that is read once and posed for any number of times.
#pragma once

#include <optional>
#include <string>

#include "dapple/scene.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/material.hpp"

namespace dapple::gltf {

class MovingGltf {
 public:
  /// `plays`: at() will be asked for times, so that animations are checked here. Throws Error
  /// input, and usage for an --animation that there is not.
  MovingGltf(const std::string& path, const SceneOptions& options, bool plays);
  // player_ refers to document_.
  MovingGltf(const MovingGltf&) = delete;
  MovingGltf& operator=(const MovingGltf&) = delete;

  /// As load_gltf(). Throws Error input where a pose is no scene.
  [[nodiscard]] Scene at(std::optional<double> seconds) const;

 private:
  SceneOptions options_;
  Document document_;
  std::optional<Player> player_;
  Scene timeless_;  ///< what does not depend on the time: materials and textures
  MaterialSet materials_;
};

}  // namespace dapple::gltf
