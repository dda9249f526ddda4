// The scenes of a render's frames. Lights and the dome of the command line are the same in all
// frames. In a sequence the first frame also chooses the camera, lights and ground that the scene
// lacks: they would jitter if each frame chose its own.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands/render/render_arguments.hpp"
#include "dapple/moving_scene.hpp"

namespace dapple {

class Shot {
 public:
  /// Reads the files. In a sequence, and with a shutter or motion vectors, opacities are applied
  /// and the ground is added here; `options.opacity` and `options.ground` are cleared.
  /// Throws Error.
  Shot(const RenderArguments& arguments, RenderOptions& options);

  Scene frame(std::optional<double> seconds);

  /// The opacities that were cleared, for the film's metadata.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings() const;

 private:
  /// Chooses camera, lights and ground from the first frame.
  struct Defaults {
    std::optional<Camera> camera;  ///< where the scene has none
    std::string camera_name;       ///< of the scene's camera that the first frame shows
    float focus_distance = 0;      ///< of the first frame, for cameras without one of their own
    std::vector<Light> lights;
    std::optional<Box3f> ground_under;
    std::vector<std::string> notes;
  };

  /// The scene after all animations, with the first frame's cameras.
  [[nodiscard]] Scene at_its_end(const Scene& first) const;
  /// `shown`: what the camera is to show, and the ground to be under.
  [[nodiscard]] Defaults choose_defaults(const Scene& first, const Scene& shown) const;
  void keep_camera(Scene& scene) const;
  void add_defaults(Scene& scene) const;

  const RenderArguments& arguments_;
  RenderOptions options_;
  std::optional<MovingScene> moving_;  ///< for several times; other scenes are read by frame()
  std::optional<std::vector<Light>> lights_;
  std::optional<Light> dome_;
  std::optional<Defaults> defaults_;
};

}  // namespace dapple
