// Part two of the accuracy bench: errors of prefiltered pictures. In: a scene and footprint scales.
// Out: bias, RMSE, noise and time for each scale, compared with exact pictures.
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

/// Errors of one pass at one footprint scale. AO is in [0,1]; lights are relative to their largest
/// unoccluded irradiance. Only pixels that show the scene count.
struct ImageError {
  std::string pass;
  double bias = 0;            ///< of the mean over pixels, prefiltered minus exact
  double converged_rmse = 0;  ///< of pixels, without noise: the error with infinitely many samples
  double noise = 0;           ///< standard deviation of a pixel, one picture
  double noise_of_mean = 0;   ///< of the mean over pixels
  double seconds = 0;  ///< of the occlusion rays of a picture, median; of all lights together
};

struct ImageAccuracyRow {
  float footprint = 0;       ///< 0: exact
  double trace_seconds = 0;  ///< all passes of one picture, median wall time
  std::vector<ImageError> passes;
};

/// Returns a row for each footprint; the row of exact pictures is the last. `progress` is called
/// with the fraction done, [0,1].
std::vector<ImageAccuracyRow> measure_images(PictureScene& scene,
                                             const ImageAccuracyOptions& options,
                                             const std::function<void(double)>& progress);

}  // namespace dapple::bench
