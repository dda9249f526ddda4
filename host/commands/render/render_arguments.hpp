// The arguments of `dapple render`. In: text as typed. Out: RenderOptions.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dapple/film.hpp"
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

/// Throws Error usage if options of the PNG are wrong, or there is none that they are for.
void check_png(const RenderArguments& arguments);

/// Whether the file is a part, FILE.dapple, and not an image.
bool is_part_path(const std::string& path);

double frames_per_second(const RenderArguments& arguments);

/// Moments of the open shutter: 1 without --shutter.
int shutter_times(const RenderArguments& arguments);

/// The k-th moment of a frame at `seconds`: the middle of the k-th part of the shutter interval.
double shutter_seconds(const RenderArguments& arguments, double seconds, int k);

/// Both throw Error usage naming the option.
RenderOptions to_options(const RenderArguments& arguments);
ExrFormat to_format(const RenderArguments& arguments);

}  // namespace dapple
