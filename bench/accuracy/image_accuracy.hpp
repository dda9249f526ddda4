// Part two of the accuracy bench: whole pictures against exact, footprint by footprint.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "accuracy/picture_scene.hpp"

namespace dapple::bench {

struct ImageAccuracyOptions {
  std::vector<float> footprints{4, 2, 1, 0.5f, 0.25f, 0.125f, 0.0625f};
  int seeds = 16;        ///< pictures of each footprint, at least 2
  RenderOptions render;  ///< size, samples, rays
};

/// One pass at one footprint. AO is in [0,1], lights relative to their largest unoccluded
/// irradiance; only pixels in which the scene is seen count.
struct ImageError {
  std::string pass;
  double bias = 0;            ///< of the mean over pixels, prefiltered minus exact
  double converged_rmse = 0;  ///< of pixels, noise taken out: what more samples do not mend
  double noise = 0;           ///< standard deviation of a pixel, one picture
  double noise_of_mean = 0;   ///< of the mean over pixels
  double seconds = 0;         ///< occlusion rays of one picture, median; lights together
};

struct ImageAccuracyRow {
  float footprint = 0;       ///< 0: exact
  double trace_seconds = 0;  ///< all passes of one picture, median wall time
  std::vector<ImageError> passes;
};

/// The exact row comes last. `progress` is told the share done.
std::vector<ImageAccuracyRow> measure_images(PictureScene& scene,
                                             const ImageAccuracyOptions& options,
                                             const std::function<void(double)>& progress);

}  // namespace dapple::bench
