// How many samples each pixel gets, tested without a renderer: allocations for known variances, and
// the rounds of a plan on pixels with Gaussian samples.
#include "sampling/sample_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "dapple/shared/pass_params.h"
#include "sampling/batch_variance.hpp"
#include "sampling/pilot_samples.hpp"
#include "sampling/sample_allocation.hpp"

namespace dapple {
namespace {

std::vector<float> rising_variances(std::size_t pixels) {
  std::vector<float> variances;
  for (std::size_t p = 0; p < pixels; ++p) {
    const float deviation = 0.05f + 0.9f * static_cast<float>(p) / static_cast<float>(pixels);
    variances.push_back(deviation * deviation);
  }
  return variances;
}

TEST(WantMultiple, MultipliesWhereAVarianceIsAboveZeroAndKeepsWhatIsWanted) {
  BatchCounts wanted{2, 2, 9, 30};
  want_multiple({0.5f, 0.0f, 0.1f, 1e-9f}, 4, {2, 2, 2, 30}, 100, wanted);
  EXPECT_EQ(wanted, (BatchCounts{8, 2, 9, 100}));
}

TEST(WantDoubles, DoublesWhereABatchLowersTheErrorMostUntilItHasFallenEnough) {
  const std::vector<float> falls{0.3f, 0.0f, 0.2f, 0.4f, 0.1f};
  const BatchCounts have{4, 2, 2, 8, 2};  // a batch lowers the error by 0.075, 0, 0.1, 0.05, 0.05
  BatchCounts wanted = have;
  want_doubles(falls, 0.15, have, 100, wanted);
  EXPECT_EQ(wanted, (BatchCounts{4, 2, 4, 8, 2}));
  want_doubles(falls, 0.45, have, 7, wanted);
  EXPECT_EQ(wanted, (BatchCounts{7, 2, 4, 8, 2})) << "the largest number is 7";
  BatchCounts others = have;
  want_doubles(falls, 0.25, have, 4, others);
  EXPECT_EQ(others, (BatchCounts{4, 2, 4, 8, 4})) << "others, where some have the largest number";
  want_doubles(falls, 10, have, 100, wanted);
  EXPECT_EQ(wanted, (BatchCounts{8, 2, 4, 16, 4})) << "not where nothing varies";
}

TEST(AllocateBatches, MultipliesByAPowerOfTwoAndDoublesOnlySomeForLess) {
  const auto allocated = [](float variance, float of_first) {
    std::vector<float> variances(64, variance);
    for (std::size_t p : {0, 1, 16, 17}) variances[p] = of_first;  // the first block
    return allocate_batches({variances}, BatchCounts(64, 4), 16, {0, 0.1f}, 100);
  };
  EXPECT_EQ(allocated(0.04f, 0.04f), BatchCounts(16, 4)) << "as the target";
  EXPECT_EQ(allocated(0.19f, 0.19f), BatchCounts(16, 16)) << "4.7 times the squared target";
  BatchCounts first(16, 4);
  first[0] = 8;
  EXPECT_EQ(allocated(0.03f, 0.25f), first) << "1.1 times the squared target";
}

TEST(SquaredErrors, AreTheSumOfVariancesOverBatches) {
  EXPECT_NEAR(squared_errors({0.5f, 0.0f, 0.25f}, {2, 3, 5}), 0.3, 1e-7);
}

TEST(WantError, RoundsUpAndKeepsToTheMaximum) {
  const std::vector<float> variances{0.01f, 0.041f, 0.1f, 0.0f};
  BatchCounts wanted(4, 2);
  want_error(variances, 0.1f, 9, wanted);  // 1, 4.1, 10 and no batches are enough
  EXPECT_EQ(wanted, (BatchCounts{2, 5, 9, 2}));
}

// Simulated pixels: the means of their batches are Gaussian around 0.
class GaussianPixels {
 public:
  explicit GaussianPixels(std::vector<float> variances)
      : variances_(std::move(variances)),
        sums_(variances_.size()),
        squares_(variances_.size()),
        batches_(variances_.size()) {}

  void trace(const SampleGroup& group) {
    for (const PixelWork& work : group.work) {
      EXPECT_EQ(work.first_sample, batches_[work.pixel] * DAPPLE_SAMPLE_BATCH);
      for (std::uint32_t s = 0; s < group.samples; s += DAPPLE_SAMPLE_BATCH) {
        const double value = normal_(random_) * std::sqrt(variances_[work.pixel]);
        sums_[work.pixel] += value;
        squares_[work.pixel] += value * value;
        ++batches_[work.pixel];
      }
    }
  }
  [[nodiscard]] double mean(std::size_t p) const { return sums_[p] / batches_[p]; }
  [[nodiscard]] std::vector<float> variances(int width) const {
    std::vector<std::uint32_t> samples;
    for (const std::uint32_t batches : batches_) samples.push_back(batches * DAPPLE_SAMPLE_BATCH);
    return batch_variances(samples, width, [&](std::size_t p) {
      return BatchMoments{static_cast<float>(mean(p)), static_cast<float>(squares_[p])};
    });
  }

 private:
  std::vector<float> variances_;
  std::vector<double> sums_, squares_;
  std::vector<std::uint32_t> batches_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

RenderOptions by_rmse(float target) {
  RenderOptions options;
  options.spp = 8;
  options.target_rmse = target;
  return options;
}

struct Drawn {
  double rmse = 0;
  int rounds = 0;
  std::vector<std::uint32_t> samples;
};

Drawn draw(int width, int height, const RenderOptions& options) {
  const std::size_t count = static_cast<std::size_t>(width) * height;
  GaussianPixels pixels(rising_variances(count));
  SamplePlan plan(width, height, options);
  const auto trace = [&](const std::vector<SampleGroup>& groups) {
    for (const SampleGroup& group : groups) pixels.trace(group);
  };
  trace(plan.pilot());
  if (plan.only_pilot_has_samples()) trace(plan.after_pilot({pixels.variances(width)}));
  for (std::vector<SampleGroup> first; !(first = plan.least()).empty();) trace(first);
  Drawn drawn;
  for (; drawn.rounds < 30; ++drawn.rounds) {
    const std::vector<SampleGroup> groups = plan.next({pixels.variances(width)});
    if (groups.empty()) break;
    trace(groups);
  }
  double squares = 0;
  for (std::size_t p = 0; p < count; ++p) squares += pixels.mean(p) * pixels.mean(p);
  drawn.rmse = std::sqrt(squares / static_cast<double>(count));
  drawn.samples = plan.samples();
  return drawn;
}

TEST(SamplePlan, GaussianPixelsReachTheRmseInFewRounds) {
  const Drawn drawn = draw(64, 64, by_rmse(0.05f));
  // The RMSE of 4,096 pixels is known to 1.1 %.
  EXPECT_NEAR(drawn.rmse, 0.05, 0.05 * 0.05);
  EXPECT_LE(drawn.rounds, 8);
  EXPECT_EQ(draw(64, 64, by_rmse(0.05f)).samples, drawn.samples);
}

TEST(SamplePlan, EveryPixelHasFromMinimumToMaximum) {
  RenderOptions options = by_rmse(0.01f);
  options.spp = 20;
  options.max_spp = 200;
  const Drawn drawn = draw(16, 16, options);
  for (const std::uint32_t samples : drawn.samples) {
    EXPECT_GE(samples, 20u);
    EXPECT_LE(samples, 200u);
  }
  EXPECT_EQ(drawn.samples.back(), 200u);
}

TEST(SamplePlan, PixelsOfABlockGetTheSame) {
  const int width = 11, height = 7;  // blocks at the right and lower border are incomplete
  const Drawn drawn = draw(width, height, by_rmse(0.05f));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t corner = static_cast<std::size_t>(y / 2 * 2) * width + x / 2 * 2;
      EXPECT_EQ(drawn.samples[static_cast<std::size_t>(y) * width + x], drawn.samples[corner]);
    }
  }
}

TEST(SamplePlan, NoPixelGetsMoreThanEightTimesWhatItHasAndAllEndAtTheMaximum) {
  RenderOptions options;
  options.target_error = 0.01f;
  options.max_spp = 200;
  SamplePlan plan(5, 2, options);
  EXPECT_EQ(plan.least().at(0).samples, 16u);
  const std::vector<std::vector<float>> variances{std::vector<float>(10, 1.0f)};
  for (int round = 0; round < 20; ++round) {
    const std::vector<std::uint32_t> before = plan.samples();
    if (plan.next(variances).empty()) break;
    for (std::size_t p = 0; p < before.size(); ++p) {
      EXPECT_LE(plan.samples()[p], 9 * before[p]);
      EXPECT_GT(plan.samples()[p], before[p]);
    }
  }
  for (const std::uint32_t samples : plan.samples()) EXPECT_EQ(samples, 200u);
  EXPECT_EQ(plan.fraction_done(), 1.0);
}

std::size_t count_of(const std::vector<std::uint32_t>& samples, std::uint32_t count) {
  return static_cast<std::size_t>(std::count(samples.begin(), samples.end(), count));
}

TEST(PilotPixels, AreSquaresAllOverThePicture) {
  const int width = 130, height = 75;
  const std::vector<bool> pilot = pilot_pixels(width, height);
  ASSERT_EQ(pilot.size(), 130u * 75u);
  std::set<std::pair<int, int>> positions;
  for (int top = 0; top + 8 <= height; top += 8) {
    for (int left = 0; left + 8 <= width; left += 8) {
      std::vector<std::pair<int, int>> of_cell;
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
          if (pilot[static_cast<std::size_t>(top + y) * width + left + x])
            of_cell.push_back({x, y});
      ASSERT_EQ(of_cell.size(), 16u);
      EXPECT_EQ(of_cell.back().first - of_cell.front().first, 3);
      EXPECT_EQ(of_cell.back().second - of_cell.front().second, 3);
      positions.insert(of_cell.front());
    }
  }
  EXPECT_EQ(positions.size(), 4u) << "no regular grid, which could miss the scene";
}

TEST(PilotPixels, AreSomeHundredSquaresOfLargePicturesAndNoneOfSmallOnes) {
  EXPECT_TRUE(pilot_pixels(63, 64).empty());
  EXPECT_TRUE(pilot_pixels(100'000, 7).empty());
  for (const auto& [width, height] : {std::pair{64, 64}, {256, 256}, {1920, 1080}, {3840, 2160}}) {
    const std::vector<bool> pilot = pilot_pixels(width, height);
    const auto count = std::count(pilot.begin(), pilot.end(), true);
    EXPECT_GE(count, 64 * 16) << width;
    EXPECT_LE(count, 1024 * 16) << width;
  }
}

TEST(SamplePlan, AfterThePilotAllPixelsGetEqualSamples) {
  RenderOptions options = by_rmse(0.1f);
  SamplePlan plan(128, 128, options);
  const std::vector<SampleGroup> pilot = plan.pilot();
  EXPECT_EQ(count_of(plan.samples(), 8), 1600u);
  EXPECT_EQ(count_of(plan.samples(), 0), 16384u - 1600u);
  ASSERT_TRUE(plan.only_pilot_has_samples());
  // With batches of variance 0.07 the squared error is 0.01 at 7 batches; the next power of two is
  // 8.
  const std::vector<SampleGroup> all = plan.after_pilot({std::vector<float>(16384, 0.07f)});
  EXPECT_EQ(count_of(plan.samples(), 8 * DAPPLE_SAMPLE_BATCH), 16384u);
  EXPECT_FALSE(plan.only_pilot_has_samples());
  GaussianPixels pixels(std::vector<float>(16384, 1.0f));
  for (const auto& groups : {pilot, all})
    for (const SampleGroup& group : groups) pixels.trace(group);  // fails if samples are left out
  EXPECT_TRUE(plan.least().empty());
}

TEST(SamplePlan, AfterThePilotSamplesAreRoundedDownIfFewAreMissing) {
  // A later round doubles those of some pixels.
  SamplePlan plan(128, 128, by_rmse(0.1f));
  plan.pilot();
  plan.after_pilot({std::vector<float>(16384, 0.067f)});
  EXPECT_EQ(count_of(plan.samples(), 4 * DAPPLE_SAMPLE_BATCH), 16384u);
}

TEST(SamplePlan, AfterThePilotNoPixelGetsMoreThanFourTimesTheMinimum) {
  SamplePlan plan(128, 128, by_rmse(0.001f));
  plan.pilot();
  plan.after_pilot({std::vector<float>(16384, 1.0f)});
  EXPECT_EQ(count_of(plan.samples(), 32), 16384u);
  EXPECT_NEAR(plan.fraction_done(), 32.0 / 4096, 1e-6) << "of the most";
}

TEST(SamplePlan, PixelsThatLackManyNumbersOfSamplesAreFewGroups) {
  std::vector<std::uint32_t> samples(64 * 64);
  for (std::size_t p = 0; p < samples.size(); ++p) samples[p] = 8 * static_cast<uint>(p % 1500);
  RenderOptions options;
  options.spp = 12000;
  SamplePlan plan(64, 64, options, samples);
  std::map<std::uint32_t, std::uint32_t> has;
  const std::vector<SampleGroup> groups = plan.least();
  EXPECT_LE(groups.size(), 14u);
  for (const SampleGroup& group : groups)
    for (const PixelWork& work : group.work) {
      const auto [at, is_first] = has.try_emplace(work.pixel, samples[work.pixel]);
      EXPECT_EQ(work.first_sample, at->second) << work.pixel;
      at->second += group.samples;
    }
  for (const auto& [pixel, samples_of_pixel] : has) EXPECT_EQ(samples_of_pixel, 12000u) << pixel;
  EXPECT_EQ(has.size(), samples.size());
}

TEST(SamplePlan, ByErrorThereIsNoPilot) {
  RenderOptions options;
  options.target_error = 0.1f;
  SamplePlan plan(128, 128, options);
  EXPECT_TRUE(plan.pilot().empty());
  EXPECT_EQ(plan.least().size(), 1u);
}

TEST(SamplePlan, APilotWithoutHitsGivesTheMinimum) {
  SamplePlan plan(128, 128, by_rmse(0.1f));
  plan.pilot();
  plan.after_pilot({std::vector<float>(16384, 0.0f)});
  EXPECT_EQ(count_of(plan.samples(), 8), 16384u);
  EXPECT_EQ(plan.fraction_done(), 1);
}

TEST(SamplePlan, ContinuesFromTheSamplesOfAnEarlierPilot) {
  const std::vector<float> variances(16384, 0.09f);
  SamplePlan plan(128, 128, by_rmse(0.1f));
  plan.pilot();
  SamplePlan later(128, 128, by_rmse(0.1f), plan.samples());
  EXPECT_TRUE(later.pilot().empty());
  ASSERT_TRUE(later.only_pilot_has_samples());
  plan.after_pilot({variances});
  later.after_pilot({variances});
  EXPECT_EQ(plan.samples(), later.samples());
}

TEST(SamplePlan, LargePicturesReachTheRmseInFewRounds) {
  const Drawn drawn = draw(128, 128, by_rmse(0.05f));
  EXPECT_NEAR(drawn.rmse, 0.05, 0.05 * 0.05);
  EXPECT_LE(drawn.rounds, 6);
}

TEST(SamplePlan, ListsEveryPixelOnceTileByTile) {
  SamplePlan plan(19, 11, RenderOptions{});
  const SampleGroup all = plan.least().at(0);
  ASSERT_EQ(all.work.size(), 19u * 11u);
  std::map<std::uint32_t, int> seen;
  for (const PixelWork& work : all.work) ++seen[work.pixel];
  EXPECT_EQ(seen.size(), all.work.size());
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_LT(all.work[i].pixel % 19, 8u);
    EXPECT_LT(all.work[i].pixel / 19, 8u);
  }
}

}  // namespace
}  // namespace dapple
