// The moments of an open shutter: which scenes they show, and how many samples each has. In: what
// the caller of render_shutter() asks for. Out: options and progress of each moment.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dapple/render.hpp"
#include "dapple/shared/light_record.h"

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

/// Says that `spp` samples are not as many for each of `times` moments.
std::string uneven_moments_note(int spp, int times);

/// What holds for the scenes at all moments together.
struct ShutterScenes {
  int count = 1;
  Box3f bounds;         ///< empty for a single moment
  bool smooth = false;  ///< at one of several moments
  /// By light, at the first moment at which it is not 0; empty for a single moment, or if lights
  /// come or go.
  std::vector<V3f> radiance;
  /// Of all lights at each moment, one moment after the other; empty as `radiance` is.
  std::vector<LightRecord> lights;
};

ShutterScenes look_at_moments(const Shutter& shutter);

/// Gives lights that are dark at the first moment the radiance that they have when they are on: at
/// moments without radiance they add nothing to the sums. Domes cannot be switched.
void set_lit_radiance(const ShutterScenes& moments, std::vector<Light>& lights);

/// The options as by_sample() returns them, with the end of the shard for `spp`, or that of the
/// first `time` + 1 moments if it is less.
RenderOptions until(const RenderOptions& options, int time, int times);

/// The progress of the first `time` moments out of `times`.
Progress part_of(const Progress& progress, int time, int times);

/// Throws Error input unless the scene at another moment has the lights and objects of the first.
void check_same_lights(const std::vector<Light>& first, const std::vector<Light>& now);
void check_same_objects(const Scene& first, const Scene& now);

}  // namespace dapple
