// The result of tracing a picture: sums of its samples, which may still be in device memory,
// numbers of samples, and errors. layers.hpp makes the film from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dapple/bias.hpp"
#include "device/context.hpp"
#include "film/sums/deep_sums.hpp"
#include "film/sums/matte_sums.hpp"
#include "film/sums/motion_sums.hpp"

namespace dapple {

struct PictureBias {
  std::vector<Bias> passes;  ///< by layer as BiasSums
  std::vector<Bias> groups;  ///< of FilmLayout::groups, then of their backs
};

struct TracedPicture {
  HostView sums;                       ///< values of std::int64_t in the order of FilmLayout
  std::vector<std::uint32_t> samples;  ///< number of samples of each pixel; 0 only if interrupted
  /// Standard errors by pass and pixel: AO, then the lights, relative to their largest unoccluded
  /// irradiance. Empty without a target, or if interrupted before they are known.
  std::vector<std::vector<float>> errors;
  std::vector<double> largest;  ///< FilmMoments::largest_values(); empty without errors and bias
  MatteSums mattes;             ///< of no pixels unless requested
  MotionSums motion;            ///< of no pixels unless requested
  DeepSums deep;                ///< of no pixels unless requested
  PictureBias bias;             ///< empty unless requested
  std::map<std::string, double> pass_seconds;  ///< device seconds by label, of all runs
  std::size_t queue_bytes = 0;
  bool interrupted = false;
  bool skipped = false;  ///< interrupted, and without sums, errors and bias: there is no time left
};

}  // namespace dapple
