// The scenes of a render's frames, and what is the same in all of them: lights and dome that the
// command line names, and of a sequence the camera, the light and the ground that the scene lacks
// and its first frame settles. They would tremble if each frame chose its own.
#pragma once

#include <optional>
#include <vector>

#include "commands/render_arguments.hpp"
#include "dapple/moving_scene.hpp"

namespace dapple {

/// Puts `lights` in place of the scene's.
void use_lights(Scene& scene, const std::vector<Light>& lights);

class Shot {
 public:
  /// Reads the files. `options` are the render's; of a sequence `options.ground` is done here, and
  /// cleared. Throws Error.
  Shot(const RenderArguments& arguments, RenderOptions& options);

  Scene frame(std::optional<double> seconds);

 private:
  /// What the first frame settles.
  struct Set {
    std::optional<Camera> camera;
    std::optional<Light> light;
    std::optional<Box3f> ground_under;
    std::vector<std::string> notes;
  };

  [[nodiscard]] Set settle(const Scene& first) const;
  void put_up(Scene& scene) const;

  const RenderArguments& arguments_;
  RenderOptions options_;
  std::optional<MovingScene> moving_;  ///< of a sequence; else the scene is read when asked for
  std::optional<std::vector<Light>> lights_;
  std::optional<Light> dome_;
  std::optional<Set> set_;
};

}  // namespace dapple
