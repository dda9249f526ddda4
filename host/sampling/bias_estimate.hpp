// Estimates the bias of prefiltered values. In: for units (8x8 pixels, or some neighbouring values)
// the sum of differences between prefiltered and exact values. Out: the mean with its standard
// error, and the RMSE over tiles of units without the noise.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dapple/bias.hpp"

namespace dapple {

/// Sums of a unit. Those of two units are independent but for the bias itself.
struct BiasUnit {
  std::uint32_t tile = 0;
  double count = 0;       ///< values of the unit; a unit without any does not count
  double difference = 0;  ///< an unbiased estimate of the sum of prefiltered less exact values
};

/// The bias of all values. `share` is copied.
Bias estimate_bias(std::vector<BiasUnit> units, double share);

/// The standard error of the mean bias of `count` values, if by their differences it is `spread`:
/// few values do not tell how they differ, and one ray more than the `rays` that were traced could
/// have differed by all of its light.
double bias_error(double spread, double count, double rays);

/// "-0.0021 +- 0.0004, RMSE over tiles 0.0035"
std::string bias_text(const Bias& bias);

/// The mean square of the bias: that of its tiles, or of its mean if that is larger.
double mean_square(const Bias& bias);
/// The standard error of mean_square().
double error_of_mean_square(const Bias& bias);

/// What a target for the whole error leaves for the noise beside a bias of this RMSE: the squares
/// of both add up to that of `target`. At least half of the target.
float noise_target(float target, double bias_rmse);

}  // namespace dapple
