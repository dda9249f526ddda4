// A scene that is prepared once and rendered many times. In: a scene and options. Out: pictures as
// arrays of AO and light values, with times of the passes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/render.hpp"

namespace dapple::bench {

/// AO, or a light's irradiance divided by its largest unoccluded irradiance.
struct PicturePass {
  std::string name;            ///< "ao" or the light's name
  std::vector<double> pixels;  ///< row-major
};

struct Picture {
  std::vector<PicturePass> passes;
  std::vector<double> largest;  ///< of each pass: the largest unoccluded irradiance; of AO: 1
  std::vector<bool> visible;    ///< pixels in which a camera ray hit something
  double ao_seconds = 0;        ///< of the occlusion pass only, by the device's clock
  double light_seconds = 0;     ///< of all lights together
  double trace_seconds = 0;     ///< of all passes, wall time
};

/// Parses "leaf=0.85" as a material's name and its opacity. Throws Error usage.
std::pair<std::string, float> parse_material_opacity(const std::string& text);

/// Objects must not move, because the device may read the BVH in place.
class PictureScene {
 public:
  /// Applies overrides, chooses the camera, adds lights and merges meshes as render() does. Opens
  /// no device.
  PictureScene(const std::string& spec, const RenderOptions& options);
  PictureScene(const PictureScene&) = delete;
  PictureScene& operator=(const PictureScene&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const SceneBvh& bvh() const { return bvh_; }
  /// Returns the device's name, and opens the device if it is not open.
  std::string device_name();

  /// `asked` may differ from the constructor's options in seed, samples, rays, estimator and
  /// footprint. Compiles kernels before the measured times begin.
  Picture render(const RenderOptions& asked);

  /// Sets the divisors of the passes for later pictures, so that all pictures of a study share
  /// them.
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
