// A scene of a Python caller, with its BVH on a device once that is needed. In: a Scene. Out: what
// occlusion() and irradiance() take.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "dapple/bvh.hpp"
#include "dapple/device.hpp"
#include "dapple/scene.hpp"

namespace dapple::python {

/// The opened device of that name. Devices stay open, since their kernels are compiled. Needs an
/// EngineLock.
Device open_device(const std::string& name);

/// Keeps the kernels of open devices for later processes. For the end of the process, while the
/// drivers are still there.
void keep_kernels();

/// A scene as queries see it: merged, with finished domes.
struct Uploaded {
  Device device;
  Scene scene;
  SceneBvh bvh;
  DeviceScene on_device;
};

/// A scene of which calls in other threads keep what they began with. Every function needs Python's
/// lock, but for Query::upload().
class SceneOnDevice {
 public:
  explicit SceneOnDevice(Scene scene) : scene_(std::make_shared<Scene>(std::move(scene))) {}

  [[nodiscard]] std::shared_ptr<const Scene> scene() const { return scene_; }

  /// The scene to change. It is a copy if someone still uses the one before.
  Scene& change() {
    if (scene_.use_count() > 1) scene_ = std::make_shared<Scene>(*scene_);
    uploaded_.reset();
    return *scene_;
  }

  /// The scene for one call.
  struct Query {
    std::shared_ptr<const Scene> scene;
    std::string device;
    std::shared_ptr<const Uploaded> uploaded;

    /// Builds and uploads unless an earlier call did. Needs an EngineLock, not Python's lock.
    const Uploaded& upload();
  };
  [[nodiscard]] Query query(const std::string& device) const {
    return {scene_, device, device == device_ ? uploaded_ : nullptr};
  }
  /// Keeps what `query` uploaded for the next call.
  void keep(const Query& query) {
    if (query.scene != scene_) return;
    device_ = query.device;
    uploaded_ = query.uploaded;
  }

 private:
  std::shared_ptr<Scene> scene_;
  std::string device_;
  std::shared_ptr<const Uploaded> uploaded_;
};

}  // namespace dapple::python
