// How far a pixel's mean probably is from what it converges to, from the means of its batches.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/shared/pass_params.h"
#include "sampling/pixel_neighbourhood.hpp"

namespace dapple {

/// Of one pixel in one pass. A batch is DAPPLE_SAMPLE_BATCH samples, a pair two batches in a row.
struct BatchMoments {
  float mean = 0;           ///< of all samples
  float squares = 0;        ///< of the batches' means, summed
  float pair_squares = -1;  ///< of the pairs' means, batches alone counting half; below 0: unknown
};

/// Weight of the neighbourhood's variance, in batches. Small weights make the number of samples
/// depend on the pixel's own values, which biases it, and miss pixels whose first samples missed an
/// edge; larger ones take more samples (experiment 502).
inline constexpr float kNeighbourhoodWeight = 16.0f;

/// Batches from which on pairs of them tell a variance.
inline constexpr std::uint32_t kBatchesOfPairs = 4;

/// Differences that a pixel's variance is known from. `batches`: two or more.
inline float freedom_of(std::uint32_t batches) {
  return static_cast<float>((batches >= kBatchesOfPairs ? (batches + 1) / 2 : batches) - 1);
}

/// Of one batch's mean, by those of the pixel itself. With more than one batch alone, since samples
/// came in several rounds, it is rather too large.
inline float batch_variance(const BatchMoments& of_pixel, std::uint32_t batches) {
  const auto count = static_cast<float>(batches);
  const float square = count * of_pixel.mean * of_pixel.mean;
  const bool by_pairs = batches >= kBatchesOfPairs && of_pixel.pair_squares >= 0;
  const float over = (by_pairs ? 2 * of_pixel.pair_squares : of_pixel.squares) - square;
  return std::max(0.0f, over) / (by_pairs ? freedom_of(batches) : count - 1);
}

/// Variance of one batch's mean for each pixel; a pixel's mean over b batches has that over b. The
/// batches of a pair are stratified together and complete each other, so that the means of pairs
/// differ by less than those of as many batches would: where there are two pairs these tell. Few of
/// either say little of their own pixel: its eight neighbours stand in, with the weight of sixteen
/// more. `samples`: of each pixel; those with less than two batches count for nothing and have 0.
/// Pixels `width` a row; `moments`: a pixel's BatchMoments, asked for more than once.
template <class Moments>
std::vector<float> batch_variances(const std::vector<std::uint32_t>& samples, int width,
                                   const Moments& moments) {
  const auto batches = [&](std::size_t p) {
    return samples[p] / DAPPLE_SAMPLE_BATCH;
  };  // whole ones
  const auto own = [&](std::size_t p) -> std::array<float, 2> {
    if (batches(p) < 2) return {};
    return {batch_variance(moments(p), batches(p)), 1.0f};
  };
  std::vector<float> variances(samples.size());
  const auto blend = [&](std::size_t p, const std::array<float, 2>& of_pixel,
                         const std::array<float, 2>& sums) {
    if (sums[0] == 0) return;  // most pixels of a picture of one plant
    if (batches(p) < 2) return;
    const float freedom = freedom_of(batches(p));
    const float around = sums[0] / sums[1] * kNeighbourhoodWeight;
    variances[p] = (of_pixel[0] * freedom + around) / (freedom + kNeighbourhoodWeight);
  };
  visit_neighbourhoods(samples.size(), width, own, blend);
  return variances;
}

/// Fills in those of pixels with one batch: the variance among the means of it and its neighbours,
/// which is that of samples and what the picture shows together, times what it is too large by, of
/// all, where more batches tell. Arguments as for batch_variances(), which `variances` are from.
template <class Moments>
void add_variances_of_single_batches(const std::vector<std::uint32_t>& samples, int width,
                                     const Moments& moments, std::vector<float>& variances) {
  const auto is_single = [](std::uint32_t s) { return s / DAPPLE_SAMPLE_BATCH == 1; };
  if (std::none_of(samples.begin(), samples.end(), is_single)) return;
  const auto own = [&](std::size_t p) -> std::array<float, 4> {
    if (samples[p] == 0) return {};
    const float mean = moments(p).mean;
    return {mean, mean * mean, 1.0f, DAPPLE_SAMPLE_BATCH / static_cast<float>(samples[p])};
  };
  std::vector<float> spreads(samples.size());
  visit_neighbourhoods(samples.size(), width, own,
                       [&](std::size_t p, const auto&, const std::array<float, 4>& sums) {
                         if (sums[2] < 2) return;
                         const float over = sums[1] - sums[0] * sums[0] / sums[2];
                         spreads[p] = std::max(0.0f, over) / (sums[2] - 1);
                         // Of others what it would be if the neighbours had one batch each, too.
                         if (!is_single(samples[p]))
                           spreads[p] += variances[p] * (1.0f - sums[3] / sums[2]);
                       });
  double known = 0, spread = 0;
  for (std::size_t p = 0; p < samples.size(); ++p) {
    if (samples[p] < 2 * DAPPLE_SAMPLE_BATCH) continue;
    known += variances[p];
    spread += spreads[p];
  }
  const auto factor = static_cast<float>(spread > 0 ? known / spread : 1.0);
  for (std::size_t p = 0; p < samples.size(); ++p)
    if (is_single(samples[p])) variances[p] = factor * spreads[p];
}

}  // namespace dapple
