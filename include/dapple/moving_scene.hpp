// A scene that moves: it is read once and posed for any number of times. In: the arguments of
// load_scene(); out: one Scene for each time. The meshes keep number and order of their vertices
// and primitives.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

class MovingScene {
 public:
  /// Reads and checks everything that does not depend on the time; ignores `options.time`. Throws
  /// Error as load_scene() does.
  explicit MovingScene(const std::string& spec, const SceneOptions& options = {});
  ~MovingScene();
  MovingScene(MovingScene&&) noexcept;
  MovingScene& operator=(MovingScene&&) noexcept;

  /// The scene at that time in seconds; none: at rest. Throws Error input if the pose is invalid.
  [[nodiscard]] Scene at(std::optional<double> seconds) const;

  class Source;

 private:
  std::unique_ptr<const Source> source_;
};

}  // namespace dapple
