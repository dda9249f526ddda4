// What a Renderer keeps from one picture for the next: device, BVH and the scene on the device. In:
// a scene. Out: the scene on the device, built at first and refitted later, and statistics of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dapple/render.hpp"
#include "device/context.hpp"
#include "device/programs/compiler_processes.hpp"
#include "device/programs/kernel_loader.hpp"
#include "device/upload/scene_upload.hpp"

namespace dapple {

struct KeptScene {
  std::optional<Device> device;
  std::unique_ptr<KernelLoader> loader;  ///< of the device
  std::optional<UpdatableBvh> bvh;
  DeviceScene on_device;

  /// Keeps an open device.
  void use(const Device& opened);

  /// Opens the device that the options name, unless it is open.
  void open(const RenderOptions& options, RenderStatistics& statistics);

  /// Builds or refits the BVH and uploads the scene. `cache`: folder of cached BVHs, or empty.
  void update_scene(const Scene& scene, const UploadOptions& uploading, const std::string& cache,
                    RenderStatistics& statistics);

  /// Waits for the kernels that `loader` loads, loads those that `processes` compiled, and compiles
  /// the rest.
  void compile(const std::vector<KernelName>& kernels, CompilerProcesses& processes,
               RenderStatistics& statistics) const;
};

/// The sum of the seconds of all steps so far; what is left of the total is the current step's.
double counted_seconds(const RenderStatistics& statistics);

}  // namespace dapple
