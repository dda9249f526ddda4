// The settings that decide a picture's bits, as names and values. A checkpoint stores them, and a
// resumed render must have the same ones. Samples a pixel and targets are not among them, since
// they may grow.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bvh.hpp"
#include "device/upload/scene_upload.hpp"

namespace dapple {

/// A setting's name, for messages, and a value that is compared for equality.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// The settings of the command line. Numbers are printed so that they read back to the same bits.
Settings option_settings(const RenderOptions& options, const View& view);

/// Checksums of camera, scene, lights and kernels.
Settings content_settings(const RenderOptions& options, const View& view, const SceneBvh& bvh,
                          const DeviceBuffers& scene);

/// A checksum of texts in their order.
std::string text_checksum(const std::vector<std::string>& texts);

/// A checksum of the poses of a scene: what motion vectors depend on beside the scene that they
/// begin at.
std::string pose_checksum(const Scene& scene);

/// A setting that two files or runs have with different values; "none" where one has none.
struct Difference {
  std::string name, before, now;
  /// Values are checksums, which say nothing to users.
  [[nodiscard]] bool is_opaque() const;
};

/// The first setting of `now` that `then` lacks or has with another value.
std::optional<Difference> first_difference(const Settings& then, const Settings& now);

/// Throws Error usage, "--resume PATH: ...", naming the first setting of `now` that `then`, the
/// settings of the checkpoint `path`, lacks or has with another value.
void require_same(const std::string& path, const Settings& then, const Settings& now);

}  // namespace dapple
