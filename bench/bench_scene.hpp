// The scenes that are measured. In: a scene's name; out: the scene, its BVH, its copy on the device
// and rays. Each is made when a benchmark first needs it; later benchmarks share it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bvh.hpp"
#include "dapple/device.hpp"
#include "dapple/shared/pass_params.h"
#include "device/upload/scene_upload.hpp"
#include "passes/queues.hpp"

namespace dapple::bench {

/// AO rays for each shading point. Their footprints have the solid angle pi / (16 cos theta).
inline constexpr int kRaysPerPoint = 16;

/// A scene's name in benchmark names, and the argument of load_scene().
struct SceneRecipe {
  std::string name;
  std::string spec;
  std::vector<std::pair<std::string, float>> opacity;  ///< material name, opacity in [0,1]
};

/// tree, tree-thin, cloud, forest and hair, in the order of the table in bench/README.md.
std::vector<SceneRecipe> named_scenes();

/// The rays that the renderer makes with one sample a pixel, in the same order, in device memory.
struct SceneRays {
  Queues camera;
  std::size_t camera_count = 0;
  Queues ao;  ///< kRaysPerPoint rays from every point that a camera ray hit
  std::size_t ao_count = 0;
};

/// The device of a run. The first benchmark that needs it opens it.
class BenchDevice {
 public:
  BenchDevice(std::string name, std::string kernel_dir)
      : name_(std::move(name)), kernel_dir_(std::move(kernel_dir)) {}
  const Device& open() {
    if (!device_) device_.emplace(name_, kernel_dir_);
    return *device_;
  }

 private:
  std::string name_, kernel_dir_;
  std::optional<Device> device_;
};

/// Makes everything at its first use. Objects must not move, because the device may read the BVH in
/// place.
class BenchScene {
 public:
  BenchScene(SceneRecipe recipe, BenchDevice& device)
      : recipe_(std::move(recipe)), device_(device) {}
  BenchScene(const BenchScene&) = delete;
  BenchScene& operator=(const BenchScene&) = delete;

  [[nodiscard]] const std::string& name() const { return recipe_.name; }
  /// Ready for build_bvh(): meshes that are placed once are merged. The only light is a dome.
  const Scene& scene();
  const SceneBvh& bvh();
  const Device& device() { return device_.open(); }
  const DeviceScene& on_device();
  const SceneRays& rays();
  /// The camera of the picture that rays() belong to.
  CameraParams camera();

 private:
  SceneRecipe recipe_;
  BenchDevice& device_;
  std::optional<Scene> scene_;
  View view_;  ///< set by scene()
  std::optional<SceneBvh> bvh_;
  std::optional<DeviceScene> on_device_;
  std::optional<SceneRays> rays_;
};

}  // namespace dapple::bench
