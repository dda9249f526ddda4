// How far a pixel's mean probably is from what it converges to, from the means of its batches.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// One pass over a picture's pixels, row by row. A batch is DAPPLE_BATCH samples.
struct BatchMoments {
  std::vector<float> mean;     ///< of all samples
  std::vector<float> squares;  ///< of the batches' means, summed
};

/// Variance of one batch's mean for each pixel; a pixel's mean over b batches has that over b.
/// Few batches say little of their own pixel: its eight neighbours stand in, with the weight of
/// sixteen more. `samples`: of each pixel, two batches or more, or none: it counts for nothing then
/// and has 0. Pixels `width` a row.
std::vector<float> batch_variances(const BatchMoments& moments,
                                   const std::vector<std::uint32_t>& samples, int width);

}  // namespace dapple
