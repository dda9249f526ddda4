// How far a pixel's mean probably is from what it converges to, from the means of its batches.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/shared/pass_params.h"
#include "wavefront/pixel_neighbourhood.hpp"

namespace dapple {

/// Of one pixel in one pass. A batch is DAPPLE_BATCH samples.
struct BatchMoments {
  float mean = 0;     ///< of all samples
  float squares = 0;  ///< of the batches' means, summed
};

/// Batches that the neighbourhood counts for. Small weights make samples depend on the pixel's own
/// values, which biases it, and lose pixels whose first samples missed an edge: at 4 biases of
/// whole pictures were twice as large as at 16, and a third more pixels off by more than four
/// times their error. Larger ones take more samples.
inline constexpr float kNeighbourhoodWeight = 16.0f;

/// Variance of one batch's mean for each pixel; a pixel's mean over b batches has that over b.
/// Few batches say little of their own pixel: its eight neighbours stand in, with the weight of
/// sixteen more. `samples`: of each pixel, two batches or more, or none: it counts for nothing then
/// and has 0. Pixels `width` a row; `moments`: a pixel's BatchMoments, asked for more than once.
template <class Moments>
std::vector<float> batch_variances(const std::vector<std::uint32_t>& samples, int width,
                                   const Moments& moments) {
  const auto batches = [&](std::size_t p) {
    return static_cast<float>(samples[p] / DAPPLE_BATCH);  // whole ones
  };
  const auto own = [&](std::size_t p) -> std::array<float, 2> {
    if (samples[p] == 0) return {};
    const BatchMoments of_pixel = moments(p);
    const float square = batches(p) * of_pixel.mean * of_pixel.mean;
    return {std::max(0.0f, (of_pixel.squares - square) / (batches(p) - 1.0f)), 1.0f};
  };
  std::vector<float> variances(samples.size());
  const auto blend = [&](std::size_t p, const std::array<float, 2>& of_pixel,
                         const std::array<float, 2>& sums) {
    if (samples[p] == 0) return;
    const float freedom = batches(p) - 1.0f;
    const float around = sums[0] / sums[1] * kNeighbourhoodWeight;
    variances[p] = (of_pixel[0] * freedom + around) / (freedom + kNeighbourhoodWeight);
  };
  visit_neighbourhoods(samples.size(), width, own, blend);
  return variances;
}

}  // namespace dapple
