// How many samples pixels should have in all: enough everywhere, or where they help most.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// Batches of DAPPLE_SAMPLE_BATCH samples that each pixel, or block of pixels, has or should have.
using BatchCounts = std::vector<std::uint32_t>;

/// What allocations keep to.
struct AllocationLimits {
  std::uint32_t unit = 1;  ///< batches: what a pixel is given more is a multiple of this
  std::uint32_t most = 1;  ///< batches a pixel, which goes before `unit`
};

/// Raises `wanted`, from `have` up, until each pixel's standard error is below `target`.
/// `variances`: of a batch's mean, by pixel.
void want_error(const std::vector<float>& variances, float target, const BatchCounts& have,
                const AllocationLimits& limits, BatchCounts& wanted);

/// The sum of squared standard errors at so many batches a pixel.
double squared_errors(const std::vector<float>& variances, const BatchCounts& batches);

/// Raises `wanted`, from `have` up, until squared_errors() are at most `enough`, at the least cost:
/// samples of a pixel in proportion to its standard deviation over the root of what one costs
/// (Neyman, "On the Two Different Aspects of the Representative Method", 1934, section III; with
/// costs Cochran, "Sampling Techniques", 1977, section 5.5). `costs`: of a sample, by pixel, above
/// 0, in any unit. What is wanted already, for another pass, counts. Where `most` is in the way,
/// all pixels that vary want that. Where this would save little, all that vary get the same.
void want_rmse(const std::vector<float>& variances, const std::vector<float>& costs, double enough,
               const BatchCounts& have, const AllocationLimits& limits, BatchCounts& wanted);

}  // namespace dapple
