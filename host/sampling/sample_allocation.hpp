// Decides how many sample batches pixels should have: which pixels get more samples. In: variances,
// the samples that pixels have, and a target. Out: batches of each block of 2x2 pixels. For a
// target RMSE numbers are doubled, because the sequence is stratified best at powers of two: of all
// blocks that vary, or of those where a batch lowers the error most, until the rest is small
// enough.
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

/// Raises `wanted` of blocks with a variance above 0 to `factor` times what they have, at most
/// `max`.
void want_multiple(const std::vector<float>& variances, std::uint32_t factor,
                   const BatchCounts& have, std::uint32_t max, BatchCounts& wanted);

/// Raises `wanted` of blocks to twice what they have, at most `max`: of those where a batch lowers
/// the sum of squared errors most, until it has fallen by `excess`. `falls`: by how much it falls.
void want_doubles(const std::vector<float>& falls, double excess, const BatchCounts& have,
                  std::uint32_t max, BatchCounts& wanted);

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
