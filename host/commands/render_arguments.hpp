// The arguments of `dapple render`. In: text as typed. Out: RenderOptions.
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
  std::string estimator = "prefiltered", passes = "ao,light,albedo", packets = "auto";
  std::string normals = "shading", exposure = "auto", background = "sky";
  std::string look_from, look_at, up, crop;
  std::vector<std::string> opacity;
  std::optional<double> frame;
  std::string frames;
  double fps = 24;
  std::string checkpoint, checkpoint_every = "60s", resume;
  SceneOptions scene_options;
  RenderOptions options;
  std::optional<int> spp;
  bool quiet = false;
};

void add_render_options(CLI::App& app, RenderArguments& arguments);

/// Throws Error usage naming the option.
RenderOptions to_options(const RenderArguments& arguments);

}  // namespace dapple
