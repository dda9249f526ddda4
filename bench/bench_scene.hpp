// The scenes that are measured: made, built, uploaded and given rays once, on the first
// benchmark that asks, and shared by all that follow.
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

/// AO rays a shading point, which also sets their footprints: pi / (16 cos theta).
inline constexpr int kRaysPerPoint = 16;

/// What a scene is called in benchmark names, and what load_scene() makes it from.
struct SceneRecipe {
  std::string name;
  std::string spec;
  std::vector<std::pair<std::string, float>> opacity;  ///< material name, opacity in [0,1]
};

/// tree, tree-thin, cloud, forest and hair, in the order of the README's table.
std::vector<SceneRecipe> named_scenes();

/// The rays the renderer itself would shoot at one sample a pixel, in its order, resident
/// on the device.
struct SceneRays {
  Queues camera;
  std::size_t camera_count = 0;
  Queues ao;  ///< kRaysPerPoint from every point that a camera ray met
  std::size_t ao_count = 0;
};

/// The one device of a run, opened by the first benchmark that needs it.
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

/// Everything is made on first use. Objects must stay where they are: the device may read
/// the BVH in place.
class BenchScene {
 public:
  BenchScene(SceneRecipe recipe, BenchDevice& device)
      : recipe_(std::move(recipe)), device_(device) {}
  BenchScene(const BenchScene&) = delete;
  BenchScene& operator=(const BenchScene&) = delete;

  [[nodiscard]] const std::string& name() const { return recipe_.name; }
  /// Ready for build_bvh(): meshes that are placed once are merged. A dome is its only light.
  const Scene& scene();
  const SceneBvh& bvh();
  const Device& device() { return device_.open(); }
  const DeviceScene& on_device();
  const SceneRays& rays();
  /// That of the picture.
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
