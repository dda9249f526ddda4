// OpenCL devices, without OpenCL types: lists them, opens one, and uploads a scene to it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dapple/bvh.hpp"

namespace dapple {

/// Which occlusion rays are traversed together. It changes the time of a render. It changes results
/// only by rounding, except that prefiltered rays in point packets may stop at other nodes.
enum class Packets : std::uint8_t {
  automatic,  ///< on CPUs pixel, or point from 16 rays a point (exact rays: 32); elsewhere scalar
  none,       ///< single rays: a work-item a ray, eight boxes or triangles at a time
  pixel,      ///< coherent packets: up to 64 rays that start on neighbouring pixels
  point,      ///< shared-origin packets: up to 64 rays of one point
  scalar,     ///< for GPUs: a work-item a ray, camera rays too, one box or triangle at a time
};

struct DeviceInfo {
  std::string name, platform, driver;
  std::string kind;  ///< "CPU", "GPU" or "accelerator"
  unsigned compute_units = 0;
  std::size_t memory_bytes = 0;
  std::size_t largest_buffer_bytes = 0;
};

/// Every OpenCL device, best first. Throws Error device if there is no platform.
std::vector<DeviceInfo> list_devices();

class DeviceContext;  // host/device/context.hpp

/// An opened device with its command queue and compiled kernels; cheap to copy.
class Device {
 public:
  /// Opens the best device called `name`, or else whose name or platform contains it (in any case);
  /// the best of all if `name` is empty. Throws Error device, which lists the devices.
  explicit Device(const std::string& name = "", const std::string& kernel_dir = "",
                  Packets packets = Packets::automatic);
  Device(const Device&) = default;  // in place of moves, too: no device is without a context
  Device& operator=(const Device&) = default;
  ~Device() = default;

  [[nodiscard]] const DeviceInfo& info() const;
  /// Keeps the kernels that were compiled so far for later processes. Otherwise that happens when
  /// the last copy is destroyed.
  void keep_compiled() const;
  [[nodiscard]] DeviceContext& context() const { return *context_; }

 private:
  std::shared_ptr<DeviceContext> context_;
};

struct DeviceBuffers;  // host/device/upload/scene_upload.hpp

/// A scene in device memory. Keeps the device alive.
struct DeviceScene {
  std::shared_ptr<DeviceBuffers> buffers;
  std::size_t bytes = 0;
};

/// What is uploaded besides what rays intersect.
struct UploadOptions {
  /// Mesh::normals: 8 bytes for each lane of the blocks that hold smooth triangles, and 4 for every
  /// block.
  bool normals = false;
  bool colors = false;  ///< for the albedo: colours of materials, textures and vertices
  /// Upload normals also where all triangles are flat: at other moments of the picture they aren't.
  bool flat_normals = false;
  bool operator==(const UploadOptions&) const = default;
};

/// Copies the parts that kernels read to the device. A device that shares the host's memory reads
/// them in place. Throws Error device if they do not fit.
DeviceScene upload(const Device& device, const Scene& scene, const SceneBvh& bvh,
                   const UploadOptions& options = {});

/// Updates `bvh`, from which `on_device` was made, to `moved`, and uploads what changed: on devices
/// that share the host's memory lights, normals, colours and where instances are. Uploads
/// everything anew if `options` changed, or if `on_device` is empty, as an Error may leave it.
/// Throws as UpdatableBvh::update() and upload().
BvhUpdate update(const Device& device, DeviceScene& on_device, UpdatableBvh& bvh,
                 const Scene& moved, const UploadOptions& options = {});

}  // namespace dapple
