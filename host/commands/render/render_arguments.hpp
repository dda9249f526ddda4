// The arguments of `dapple render`, and the options that take them. In: the command line. Out: the
// arguments as typed; render_values.hpp tells what they mean.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dapple/options.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// The arguments as typed.
struct RenderArguments {
  std::string scene, output, png, stats_json, lights, dome;
  double dome_rotation = 0;
  bool footprint_given = false;
  std::string estimator = "prefiltered", passes = "ao,light,albedo", packets = "auto";
  std::string normals = "shading", exposure = "auto", background = "sky";
  std::string cryptomatte, deep, half, compression = "zip";
  bool multipart = false;
  std::string report_bias = "2%";
  std::string look_from, look_at, up, crop;
  std::vector<std::string> opacity;
  std::optional<double> frame;
  std::string frames;
  bool animate_seed = false;
  std::optional<double> fps;  ///< default 24
  std::string shutter;
  std::optional<int> motion_samples;
  std::string checkpoint, checkpoint_every = "60s", resume, resume_or_begin, shard;
  SceneOptions scene_options;
  RenderOptions options;
  std::optional<float> fov;  ///< degrees; default: the camera's own, or 40
  std::optional<int> spp;
  bool quiet = false;
};

void add_render_options(CLI::App& app, RenderArguments& arguments);

/// Those of the files that are written beside the image, and of its format.
void add_file_options(CLI::App& app, RenderArguments& arguments);

}  // namespace dapple
