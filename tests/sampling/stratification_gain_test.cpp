// How much less means of pairs of batches vary than those of independent batches: against batches
// with a known correlation.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sampling/batch_variance.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kBatches = 8;
constexpr int kWidth = 64;

/// Pixels of variance 1 for each batch; the two batches of a pair have the covariance -`rho`.
std::vector<BatchMoments> correlated_pixels(std::size_t count, double rho) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const double beside = std::sqrt(1 - rho * rho);
  std::vector<BatchMoments> pixels(count);
  for (BatchMoments& pixel : pixels) {
    double sum = 0, squares = 0, pairs = 0;
    for (std::uint32_t pair = 0; pair < kBatches / 2; ++pair) {
      const double first = normal(random), second = -rho * first + beside * normal(random);
      sum += first + second;
      squares += first * first + second * second;
      pairs += std::pow((first + second) / 2, 2);
    }
    pixel = {static_cast<float>(sum / kBatches), static_cast<float>(squares),
             static_cast<float>(pairs)};
  }
  return pixels;
}

std::vector<std::uint32_t> samples_of(std::size_t count) {
  return std::vector<std::uint32_t>(count, kBatches * DAPPLE_SAMPLE_BATCH);
}

float gain_of(std::size_t count, double rho) {
  const std::vector<BatchMoments> pixels = correlated_pixels(count, rho);
  return stratification_gain(samples_of(count), [&](std::size_t p) { return pixels[p]; });
}

// By single batches the variance is 1 + rho / 7, by pairs 1 - rho. Standard errors over 65,536
// pixels are below 0.004.
TEST(StratificationGain, IsTheVarianceByPairsOverThatByBatches) {
  EXPECT_NEAR(gain_of(1 << 16, 0), 1, 0.015);
  EXPECT_NEAR(gain_of(1 << 16, 0.1), 0.9 / (1 + 0.1 / 7), 0.015);
}

TEST(StratificationGain, IsLimitedAndNeedsEnoughPixels) {
  EXPECT_EQ(gain_of(1 << 14, 0.5), 0.8f);
  EXPECT_EQ(gain_of(1 << 14, -0.2), 1.0f);
  EXPECT_EQ(gain_of(512, 0.5), 1.0f);
}

TEST(StratificationGain, ScalesTheVariancesOfPixelsWithPairs) {
  constexpr std::size_t kPixels = kWidth * kWidth;
  const std::vector<BatchMoments> pixels = correlated_pixels(kPixels, 0.5);
  std::vector<std::uint32_t> samples = samples_of(kPixels);
  const auto moments = [&](std::size_t p) { return pixels[p]; };
  const std::size_t middle = kPixels / 2 + kWidth / 2;
  double own = 0, around = 0;
  for (const int row : {-1, 0, 1})
    for (const int column : {-1, 0, 1})
      around += double{batch_variance(pixels[middle + row * kWidth + column], kBatches)} / 9;
  own = double{batch_variance(pixels[middle], kBatches)};
  const double freedom = double{freedom_of(kBatches)}, weight = double{kNeighbourhoodWeight};
  const double expected = 0.8 * (own * freedom + around * weight) / (freedom + weight);
  EXPECT_NEAR(batch_variances(samples, kWidth, moments)[middle], expected, 1e-5);
}

}  // namespace
}  // namespace dapple
