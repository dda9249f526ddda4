// The settings that decide a picture's bits, as names and values. A checkpoint stores them, and a
// resumed render must have the same ones. Samples a pixel and targets are not among them, since
// they may grow.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "camera/view.hpp"
#include "dapple/bvh.hpp"
#include "device/upload/scene_upload.hpp"

namespace dapple {

/// Name for people, value that tells as little or as much as equality needs.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// What was asked for: flags of the command line. Values read back to the same bits.
Settings option_settings(const RenderOptions& options, const View& view);

/// What it is asked of, as checksums: camera, scene, lights, kernels.
Settings content_settings(const RenderOptions& options, const View& view, const SceneBvh& bvh,
                          const DeviceBuffers& scene);

/// Throws Error usage, "--resume PATH: ...", naming the first of `now` that was another, or was
/// not there, when the checkpoint `path` was made with `then`.
void require_same(const std::string& path, const Settings& then, const Settings& now);

}  // namespace dapple
