// Estimates the variance of pixels. In: the means of a pixel's sample batches, as sums of squares.
// Out: for each pixel the variance of the mean of one batch.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dapple/shared/pass_params.h"
#include "sampling/pixel_neighbourhood.hpp"

namespace dapple {

/// One pixel in one pass. A batch is DAPPLE_SAMPLE_BATCH samples, a pair two consecutive batches.
struct BatchMoments {
  float mean = 0;           ///< of all samples
  float squares = 0;        ///< sum of the squared means of batches
  float pair_squares = -1;  ///< the same of pairs; a single batch counts half; below 0: unknown
};

/// Weight of the neighbourhood's variance, in batches. Small weights make the number of samples
/// depend on the pixel's own values, which biases it, and miss pixels whose first samples missed an
/// edge; larger ones take more samples (experiment 502).
inline constexpr float kNeighbourhoodWeight = 16.0f;

/// With fewer batches the variance is estimated from batches, not from pairs.
inline constexpr std::uint32_t kBatchesOfPairs = 4;

/// Degrees of freedom of the estimate for a pixel with so many batches, two or more.
inline float freedom_of(std::uint32_t batches) {
  return static_cast<float>((batches >= kBatchesOfPairs ? (batches + 1) / 2 : batches) - 1);
}

/// Variance of the mean of one batch, estimated from the pixel alone. If several batches have no
/// partner, because samples came in several rounds, the estimate is too large, not too small.
inline float batch_variance(const BatchMoments& of_pixel, std::uint32_t batches) {
  const auto count = static_cast<float>(batches);
  const float square = count * of_pixel.mean * of_pixel.mean;
  const bool by_pairs = batches >= kBatchesOfPairs && of_pixel.pair_squares >= 0;
  const float over = (by_pairs ? 2 * of_pixel.pair_squares : of_pixel.squares) - square;
  return std::max(0.0f, over) / (by_pairs ? freedom_of(batches) : count - 1);
}

/// The blend of a pixel's variance with that of its neighbourhood. `sums`: of the variances of the
/// pixel and its neighbours, and the number of those that have one.
inline float blended_variance(float of_pixel, const std::array<float, 2>& sums,
                              std::uint32_t batches) {
  const float freedom = freedom_of(batches);
  const float around = sums[0] / sums[1] * kNeighbourhoodWeight;
  return (of_pixel * freedom + around) / (freedom + kNeighbourhoodWeight);
}

/// With fewer pixels their ratio is too noisy.
inline constexpr double kPixelsOfGain = 1024;
inline constexpr float kSmallestGain = 0.8f;

/// Over all pixels with pairs of batches: the variance by pairs over that by single batches. It is
/// below 1 because the batches of a pair are stratified together, and so are pairs: their mean
/// varies less than that of independent pairs, by this factor at least (experiment 550).
template <class Moments>
float stratification_gain(const std::vector<std::uint32_t>& samples, const Moments& moments) {
  using Sums = std::array<double, 3>;  // by pairs, by batches, pixels
  const Sums sums = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, samples.size(), 4096), Sums{},
      [&](const tbb::blocked_range<std::size_t>& range, Sums sum) {
        for (std::size_t p = range.begin(); p < range.end(); ++p) {
          const std::uint32_t batches = samples[p] / DAPPLE_SAMPLE_BATCH;
          if (batches < kBatchesOfPairs) continue;
          BatchMoments of_pixel = moments(p);
          if (of_pixel.squares == 0 || of_pixel.pair_squares < 0) continue;
          sum[0] += double{batch_variance(of_pixel, batches)};
          of_pixel.pair_squares = -1;
          sum[1] += double{batch_variance(of_pixel, batches)};
          sum[2] += 1;
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
      });
  if (sums[2] < kPixelsOfGain || !(sums[1] > 0)) return 1;
  return std::clamp(static_cast<float>(sums[0] / sums[1]), kSmallestGain, 1.0f);
}

/// For each pixel the variance of the mean of one batch; the variance of the mean of b batches is
/// 1 / b of it. The batches of a pair are stratified together, so that means of pairs vary less
/// than means of two independent batches: pixels with two pairs or more use these, times the
/// stratification_gain() of pairs. A pixel's estimate is blended with the mean of those of its 3 x
/// 3 neighbourhood, which has a weight of sixteen batches. `samples`: of each pixel; with fewer
/// than two batches a pixel has variance 0 and does not count. `width`: pixels of a row. `moments`:
/// returns the BatchMoments of a pixel; is called several times.
template <class Moments>
std::vector<float> batch_variances(const std::vector<std::uint32_t>& samples, int width,
                                   const Moments& moments) {
  const auto batches = [&](std::size_t p) { return samples[p] / DAPPLE_SAMPLE_BATCH; };
  const auto own = [&](std::size_t p) -> std::array<float, 2> {
    if (batches(p) < 2) return {};
    return {batch_variance(moments(p), batches(p)), 1.0f};
  };
  const float gain = stratification_gain(samples, moments);
  std::vector<float> variances(samples.size());
  const auto blend = [&](std::size_t p, const std::array<float, 2>& of_pixel,
                         const std::array<float, 2>& sums) {
    if (sums[0] == 0) return;  // most pixels of a picture of one plant
    if (batches(p) < 2) return;
    variances[p] = blended_variance(of_pixel[0], sums, batches(p)) *
                   (batches(p) >= kBatchesOfPairs ? gain : 1.0f);
  };
  visit_neighbourhoods(samples.size(), width, own, blend);
  return variances;
}

/// The same for one pixel.
template <class Moments>
float batch_variance_at(std::size_t pixel, const std::vector<std::uint32_t>& samples, int width,
                        const Moments& moments) {
  const auto batches = [&](std::size_t p) { return samples[p] / DAPPLE_SAMPLE_BATCH; };
  if (batches(pixel) < 2) return 0;
  std::array<float, 2> sums{};
  for_each_neighbour(pixel, samples.size(), width, [&](std::size_t p) {
    if (batches(p) < 2) return;
    sums[0] += batch_variance(moments(p), batches(p));
    sums[1] += 1;
  });
  if (sums[0] == 0) return 0;
  return blended_variance(batch_variance(moments(pixel), batches(pixel)), sums, batches(pixel));
}

}  // namespace dapple
