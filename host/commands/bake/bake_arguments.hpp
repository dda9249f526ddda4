// The arguments of `dapple bake`. In: text as typed. Out: BakeOptions, and where results go.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dapple/bake.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// Where AO goes: "COLOR_0.rgb" as {"COLOR_0", "rgb"}, "TEXCOORD_1.x" as {"TEXCOORD_1", "x"}, "_AO"
/// as {"_AO", ""}.
struct BakeChannel {
  std::string attribute, components;
};

struct BakeArguments {
  std::string scene, output, stats_json, png, lights, dome, uv = "auto";
  std::string checkpoint, checkpoint_every = "60s", resume;
  std::string to = "vertex", passes = "ao", blend = "multiply", bent_channel = "_BENT_NORMAL";
  std::optional<std::string> channel;  ///< as typed; channel_of() knows the defaults
  std::string at = "triangles", sides = "auto", instances = "together", estimator = "prefiltered",
              normals = "shading", report_bias = "2%";
  std::vector<std::string> opacity, occluders;
  SceneOptions scene_options;
  std::optional<int> rays;
  std::optional<float> target_error;
  int bits = 8;              ///< of a texel of the occlusion texture
  double dome_rotation = 0;  ///< degrees
  BakeOptions options;
  bool quiet = false;
};

void add_bake_options(CLI::App& app, BakeArguments& a);

/// Throws Error usage, naming the flag.
BakeOptions to_options(const BakeArguments& a);
/// Throws Error usage if an option was given that has no effect with the other options.
void refuse_options_without_effect(const CLI::App& app, const BakeOptions& options);
/// Throws Error usage for a channel that values at vertices, or of instances, cannot have.
BakeChannel channel_of(const BakeArguments& a);
/// n of "TEXCOORD_n", 0 to 9; nothing for other names.
std::optional<std::uint32_t> uv_set_of(const std::string& attribute);

}  // namespace dapple
