// Decides how many sample batches pixels should have: which pixels get more samples. In: variances,
// the samples that pixels have, and a target. Out: batches of each block of 2x2 pixels. For a
// target RMSE all blocks that vary get the same number. An allocation in proportion to the standard
// deviations (Neyman 1934) takes as long to reach the same error (experiment 536).
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// Sample batches (DAPPLE_SAMPLE_BATCH samples each), by pixel or block of pixels.
using BatchCounts = std::vector<std::uint32_t>;

/// By pass and pixel: the variance of the mean of one sample batch, as batch_variances() returns
/// it.
using PassVariances = std::vector<std::vector<float>>;

/// The error to reach. One of the two is above 0.
struct ErrorTarget {
  float error = 0;  ///< the standard error of each pixel
  float rmse = 0;   ///< the root mean square of the errors of all pixels
};

/// The sum of squared standard errors with so many batches. `variances`: of the mean of one batch.
/// Does not depend on threads.
double squared_errors(const std::vector<float>& variances, const BatchCounts& batches);

/// The sum of squared errors of so many pixels whose root mean square error is `rmse`.
double squared_target(float rmse, std::size_t pixels);

/// Raises `wanted` to `batches`, rounded up and at most `max`, where a variance is above 0.
void want_equal(const std::vector<float>& variances, double batches, std::uint32_t max,
                BatchCounts& wanted);

/// Raises `wanted` until each standard error is at most `target`, but not above `max`.
void want_error(const std::vector<float>& variances, float target, std::uint32_t max,
                BatchCounts& wanted);

/// For each block of pixels the largest number of batches that one of them has.
BatchCounts block_maxima(const BatchCounts& batches, int width);

/// Batches, at most `max`, that each block of pixels should have in all to reach the target in
/// every pass, and at least block_maxima(). `have`: by pixel; `width`: pixels of a row.
BatchCounts allocate_batches(const PassVariances& variances, const BatchCounts& have, int width,
                             ErrorTarget target, std::uint32_t max);

}  // namespace dapple
