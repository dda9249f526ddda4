// The moments of an open shutter: which scenes they show, and how many samples each has. In: what
// the caller of render_shutter() asks for. Out: options and progress of each moment.
#pragma once

#include <functional>
#include <vector>

#include "dapple/render.hpp"

namespace dapple {

/// As render_shutter() takes them.
struct Shutter {
  const std::function<Scene(int)>& scene_at;
  int times;
  const std::function<Scene(int)>& next_at;  ///< for motion vectors
};

/// Throws Error usage for options that do not go with a shutter or with motion vectors.
void check_shutter(const Shutter& shutter, const RenderOptions& options,
                   const RenderControl& control);

/// What holds for the scenes at all moments together. Empty for a single moment.
struct ShutterScenes {
  Box3f bounds;
  bool smooth = false;  ///< at some moment
};

ShutterScenes look_at_moments(const Shutter& shutter);

/// The options as by_sample() returns them, with the end of the shard for `spp`, or that of the
/// first `time` + 1 moments if it is less.
RenderOptions until(const RenderOptions& options, int time, int times);

/// The progress of the first `time` moments out of `times`.
Progress part_of(const Progress& progress, int time, int times);

/// Throws Error input unless the scene at another moment has the lights and objects of the first.
void check_same_lights(const std::vector<Light>& first, const std::vector<Light>& now);
void check_same_objects(const Scene& first, const Scene& now);

}  // namespace dapple
