// A scene set up once and rendered many times: what render() does, with the building taken
// out, and pictures as plain values of what is judged.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/render.hpp"

namespace dapple::bench {

/// AO, or a light's irradiance over the largest it would have unoccluded.
struct PicturePass {
  std::string name;            ///< "ao" or the light's name
  std::vector<double> pixels;  ///< row-major
};

struct Picture {
  std::vector<PicturePass> passes;
  std::vector<double> largest;  ///< of each pass: the unoccluded irradiance divided by; AO: 1
  std::vector<bool> visible;    ///< pixels in which a camera ray met something
  double ao_seconds = 0;        ///< of the occlusion pass alone, by the device's clock
  double light_seconds = 0;     ///< of all lights together
  double trace_seconds = 0;     ///< of all passes, wall time
};

/// "leaf=0.85" as a material's name and its opacity. Throws Error usage.
std::pair<std::string, float> parse_material_opacity(const std::string& text);

/// Objects must stay where they are: the device may read the BVH in place.
class PictureScene {
 public:
  /// Overrides, camera, lights and merging as in render(); no device yet.
  PictureScene(const std::string& spec, const RenderOptions& options);
  PictureScene(const PictureScene&) = delete;
  PictureScene& operator=(const PictureScene&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const SceneBvh& bvh() const { return bvh_; }
  /// The device's name; opens it.
  std::string device_name();

  /// `asked` may differ from the constructor's in seed, samples, rays, estimator and
  /// footprint. Compiles on first use, outside the times.
  Picture render(const RenderOptions& asked);

  /// What a light pass is relative to from now on; the pictures of one study share it.
  void set_largest(std::vector<double> largest) { largest_ = std::move(largest); }

 private:
  void open();

  RenderOptions options_;
  View view_;
  Scene scene_;
  SceneBvh bvh_;
  std::optional<Device> device_;
  DeviceScene on_device_;
  std::vector<double> largest_;
  std::map<std::string, double> seconds_before_;
};

}  // namespace dapple::bench
