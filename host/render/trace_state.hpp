// The state of a render between two slices: sums, samples given out, position in the round. A
// render that continues from it ends with the same bits as one that was never interrupted.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "device/context.hpp"
#include "film/sums/bias_sums.hpp"
#include "film/sums/deep_sums.hpp"
#include "film/sums/motion_sums.hpp"
#include "sampling/round.hpp"

namespace dapple {

/// So many that a slice's rays can be numbered, with several for each sample.
inline constexpr std::uint32_t kMaxSliceSamples = 1u << 26;

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

  /// In place of `sums` and `squares`, while the device has them: only until the function returns
  /// that the state is given to, because kernels add to them later.
  HostView device_sums, device_squares;

  [[nodiscard]] std::span<const std::int64_t> sum_values() const {
    return sums.empty() ? device_sums.values<std::int64_t>() : sums;
  }
  [[nodiscard]] std::span<const float> square_values() const {
    return squares.empty() ? device_squares.values<float>() : squares;
  }

  /// A state that may be kept: it has all values itself.
  [[nodiscard]] TraceState copy() const {
    TraceState state = *this;
    state.sums.assign(sum_values().begin(), sum_values().end());
    state.squares.assign(square_values().begin(), square_values().end());
    state.device_sums = state.device_squares = {};
    return state;
  }
};

}  // namespace dapple
