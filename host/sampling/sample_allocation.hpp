// Allocates sample batches. In: variances and a target. Out: how many batches each pixel, or block
// of pixels, should have in all. For a target RMSE all that vary get the same number: in proportion
// to standard deviations (Neyman 1934) costs as much to the same error, experiment 536.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// Sample batches (DAPPLE_SAMPLE_BATCH samples each), by pixel or block of pixels.
using BatchCounts = std::vector<std::uint32_t>;

/// The sum of squared standard errors with so many batches. `variances`: of the mean of one batch.
/// Does not depend on threads.
double squared_errors(const std::vector<float>& variances, const BatchCounts& batches);

/// Raises `wanted` to `batches`, rounded up and at most `max`, where a variance is above 0.
void want_equal(const std::vector<float>& variances, double batches, std::uint32_t max,
                BatchCounts& wanted);

/// Raises `wanted` until each standard error is at most `target`, but not above `max`.
void want_error(const std::vector<float>& variances, float target, std::uint32_t max,
                BatchCounts& wanted);

}  // namespace dapple
