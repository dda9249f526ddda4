// The state of a render between two slices: sums, samples given out, position in the round. A
// render that continues from it ends with the same bits as one that was never interrupted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "film/bias_sums.hpp"
#include "film/deep_sums.hpp"
#include "film/motion_sums.hpp"
#include "sampling/round.hpp"

namespace dapple {

struct TraceState {
  std::uint32_t slice_samples = 0;     ///< samples of a slice; chosen by the first device
  std::uint32_t first_sample = 0;      ///< the number of each pixel's first sample
  std::vector<std::int64_t> sums;      ///< planes as FilmLayout says
  std::vector<float> squares;          ///< planes as FilmLayout says; empty without a target
  std::vector<std::uint32_t> samples;  ///< of each pixel, those of the whole round included
  std::vector<std::uint32_t> mattes;   ///< MatteSums::packed(), if requested
  MotionSums motion;                   ///< of no pixels unless requested
  DeepSums deep;                       ///< the same; not in checkpoints
  BiasSums bias;                       ///< of the samples of this run; not in checkpoints
  Round round;
  std::map<std::string, double> pass_seconds;  ///< device seconds so far, by label
};

}  // namespace dapple
