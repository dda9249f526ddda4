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

/// Of one pixel in one pass. A batch is DAPPLE_BATCH samples, a pair two batches in a row.
struct BatchMoments {
  float mean = 0;           ///< of all samples
  float squares = 0;        ///< of the batches' means, summed
  float pair_squares = -1;  ///< of the pairs' means, summed; less than they can be: not known
};

/// Batches that the neighbourhood counts for. Small weights make samples depend on the pixel's own
/// values, which biases it, and lose pixels whose first samples missed an edge: at 4 biases of
/// whole pictures were twice as large as at 16, and a third more pixels off by more than four
/// times their error. Larger ones take more samples.
inline constexpr float kNeighbourhoodWeight = 16.0f;

/// Whether a pixel's pairs tell its variance: where there are two or more, and nothing beside them.
inline bool knows_pairs(std::uint32_t batches) { return batches >= 4 && batches % 2 == 0; }

/// Differences that a pixel's variance is known from. `batches`: two or more.
inline float freedom_of(std::uint32_t batches) {
  return static_cast<float>((knows_pairs(batches) ? batches / 2 : batches) - 1);
}

/// Of one batch's mean, by those of the pixel itself.
inline float batch_variance(const BatchMoments& of_pixel, std::uint32_t batches) {
  const auto count = static_cast<float>(batches);
  const float square = count * of_pixel.mean * of_pixel.mean;
  // A sample that is given out without its pair's other ones leaves less than there must be.
  const float of_pairs = 2 * of_pixel.pair_squares - square;
  const float of_batches = of_pixel.squares - square;
  const bool by_pairs = knows_pairs(batches) && of_pairs >= 0;
  return by_pairs ? of_pairs / freedom_of(batches) : std::max(0.0f, of_batches) / (count - 1);
}

/// Variance of one batch's mean for each pixel; a pixel's mean over b batches has that over b. The
/// batches of a pair are stratified together and complete each other, so that the means of pairs
/// differ by less than those of as many batches would: where there are two pairs these tell. Few of
/// either say little of their own pixel: its eight neighbours stand in, with the weight of sixteen
/// more. `samples`: of each pixel, two batches or more, or none: it counts for nothing then and has
/// 0. Pixels `width` a row; `moments`: a pixel's BatchMoments, asked for more than once.
template <class Moments>
std::vector<float> batch_variances(const std::vector<std::uint32_t>& samples, int width,
                                   const Moments& moments) {
  const auto batches = [&](std::size_t p) { return samples[p] / DAPPLE_BATCH; };  // whole ones
  const auto own = [&](std::size_t p) -> std::array<float, 2> {
    if (samples[p] == 0) return {};
    return {batch_variance(moments(p), batches(p)), 1.0f};
  };
  std::vector<float> variances(samples.size());
  const auto blend = [&](std::size_t p, const std::array<float, 2>& of_pixel,
                         const std::array<float, 2>& sums) {
    if (samples[p] == 0) return;
    const float freedom = freedom_of(batches(p));
    const float around = sums[0] / sums[1] * kNeighbourhoodWeight;
    variances[p] = (of_pixel[0] * freedom + around) / (freedom + kNeighbourhoodWeight);
  };
  visit_neighbourhoods(samples.size(), width, own, blend);
  return variances;
}

}  // namespace dapple
