// Variances of pixels from the moments of their batches, against those of batches whose means are
// known.
#include "sampling/batch_variance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dapple/shared/pass_params.h"

namespace dapple {
namespace {

TEST(BatchVariances, OfKnownBatchesAreTheirSampleVariance) {
  // Sixty-four equal pixels, each of two batches with means 0.2 and 0.6: the variance is 0.08.
  const std::vector<std::uint32_t> samples(64, 2 * DAPPLE_SAMPLE_BATCH);
  const auto moments = [](std::size_t) { return BatchMoments{0.4f, 0.4f}; };
  for (const float variance : batch_variances(samples, 8, moments)) {
    EXPECT_NEAR(variance, 0.08f, 1e-6f);
  }
}

TEST(BatchVariances, UsePairsFromTwoPairsOn) {
  // The means of the batches are 0, 2, 1, 3, those of the pairs 1 and 2. So the variance of a
  // pair's mean is 0.5, and that of a batch's mean twice as large.
  const std::vector<std::uint32_t> samples(64, 4 * DAPPLE_SAMPLE_BATCH);
  const auto moments = [](std::size_t) { return BatchMoments{1.5f, 14.0f, 5.0f}; };
  for (const float variance : batch_variances(samples, 8, moments)) EXPECT_NEAR(variance, 1, 1e-6f);
}

TEST(BatchVariances, UseTwoPairsAndASingleBatch) {
  // The means of the batches are 0 and 2, 3 and 5, and a single 5. The sum of squares of the pairs'
  // means is 1 + 16, plus 25 / 2 for the single batch. The mean of all is 3.
  const std::vector<std::uint32_t> samples(64, 5 * DAPPLE_SAMPLE_BATCH);
  const auto moments = [](std::size_t) { return BatchMoments{3.0f, 63.0f, 29.5f}; };
  for (const float variance : batch_variances(samples, 8, moments))
    EXPECT_NEAR(variance, (59.0f - 45.0f) / 2, 1e-5f);
}

TEST(BatchVariances, UseBatchesWherePairsAreUnknown) {
  const std::vector<std::uint32_t> samples(64, 4 * DAPPLE_SAMPLE_BATCH);
  const auto moments = [](std::size_t) { return BatchMoments{1.5f, 14.0f}; };
  for (const float variance : batch_variances(samples, 8, moments))
    EXPECT_NEAR(variance, 5.0f / 3, 1e-6f);
}

TEST(BatchVariances, IgnorePixelsWithoutSamples) {
  // The middle pixel has batches of means 1 and 3, the others have none.
  const auto moments = [](std::size_t p) {
    return p == 4 ? BatchMoments{2.0f, 10.0f} : BatchMoments{std::nanf(""), 0.0f};
  };
  std::vector<std::uint32_t> samples(9);
  samples[4] = 2 * DAPPLE_SAMPLE_BATCH;
  const std::vector<float> variances = batch_variances(samples, 3, moments);
  for (std::size_t p = 0; p < 9; ++p) EXPECT_EQ(variances[p], p == 4 ? 2.0f : 0.0f) << p;
}

TEST(BatchVariances, UseNeighboursWhereAPixelHasFewBatches) {
  const std::vector<std::uint32_t> samples(9, 2 * DAPPLE_SAMPLE_BATCH);
  // Only in the middle pixel do the batches differ: their means are 0 and 1.
  const auto moments = [](std::size_t p) { return BatchMoments{0.5f, p == 4 ? 1.0f : 0.5f}; };
  const std::vector<float> variances = batch_variances(samples, 3, moments);
  // The pixel's own 0.5 has weight 1, the neighbourhood's mean 0.5 / 9 has weight 16.
  EXPECT_NEAR(variances[4], (0.5f + 16 * 0.5f / 9) / 17, 1e-6f);
  EXPECT_NEAR(variances[0], 16 * 0.5f / 4 / 17, 1e-6f) << "a corner has four in its neighbourhood";
}

}  // namespace
}  // namespace dapple
