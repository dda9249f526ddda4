// A scene that moves: read once, posed for any number of times. In: what load_scene() takes; out: a
// Scene a time, whose meshes keep their vertices and primitives in number and order.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

class MovingScene {
 public:
  /// Reads and checks all that does not depend on the time; `options.time` is not looked at.
  /// Throws Error as load_scene() does.
  explicit MovingScene(const std::string& spec, const SceneOptions& options = {});
  ~MovingScene();
  MovingScene(MovingScene&&) noexcept;
  MovingScene& operator=(MovingScene&&) noexcept;

  /// The scene at that time in seconds; none: at rest. Throws Error input where a pose is no scene.
  [[nodiscard]] Scene at(std::optional<double> seconds) const;

  class Source;

 private:
  std::unique_ptr<const Source> source_;
};

}  // namespace dapple
