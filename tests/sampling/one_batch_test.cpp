// --target-rmse where one batch a pixel is enough: who decides that, from what, and what is known
// of the error then.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "dapple/shared/pass_params.h"
#include "dapple/wavefront.hpp"
#include "sampling/batch_variance.hpp"
#include "sampling/sample_plan.hpp"

namespace dapple {
namespace {

constexpr int kSide = 128;
constexpr std::size_t kPixels = std::size_t{kSide} * kSide, kPilot = 1600;

RenderOptions by_rmse(float target, int spp = 1) {
  RenderOptions options;
  options.spp = spp;
  options.target_rmse = target;
  return options;
}

using Variances = std::vector<std::vector<float>>;

Variances all_equal(float variance) { return {std::vector<float>(kPixels, variance)}; }

std::vector<float> no_costs() { return std::vector<float>(kPixels, 1.0f); }

std::size_t with_batches(const SamplePlan& plan, std::uint32_t batches) {
  const auto& samples = plan.samples();
  return static_cast<std::size_t>(
      std::count(samples.begin(), samples.end(), batches * DAPPLE_SAMPLE_BATCH));
}

SamplePlan after_pilot(const RenderOptions& options, const Variances& variances) {
  SamplePlan plan(kSide, kSide, options);
  plan.pilot();
  plan.after_pilot(variances);
  return plan;
}

TEST(OneBatch, IsAllThatOtherPixelsThanThePilotsGetWhereItIsEnough) {
  SamplePlan plan = after_pilot(by_rmse(0.1f), all_equal(0.0079f));
  EXPECT_EQ(with_batches(plan, 1), kPixels - kPilot);
  EXPECT_EQ(with_batches(plan, 2), kPilot);
  EXPECT_TRUE(plan.least().empty());
  EXPECT_TRUE(plan.next(all_equal(0.0079f), no_costs).empty());
  EXPECT_EQ(plan.fraction_done(), 1);
}

TEST(OneBatch, NeedsAMarginAndEveryPass) {
  EXPECT_EQ(with_batches(after_pilot(by_rmse(0.1f), all_equal(0.0081f)), 2), kPixels);
  const Variances two_passes{all_equal(0.001f)[0], all_equal(0.02f)[0]};
  EXPECT_EQ(with_batches(after_pilot(by_rmse(0.1f), two_passes), 2), kPixels);
  const Variances one_sees_nothing{all_equal(0.001f)[0], all_equal(0.0f)[0]};
  EXPECT_EQ(with_batches(after_pilot(by_rmse(0.1f), one_sees_nothing), 1), kPixels - kPilot);
}

TEST(OneBatch, IsNotTakenForGrantedByPilotPixelsWithoutHits) {
  EXPECT_EQ(with_batches(after_pilot(by_rmse(0.1f), all_equal(0.0f)), 2), kPixels);
}

TEST(OneBatch, IsNotEnoughWhereMoreAreAskedForOrEachPixelHasATarget) {
  const auto two = static_cast<int>(2 * DAPPLE_SAMPLE_BATCH);
  EXPECT_EQ(with_batches(after_pilot(by_rmse(0.1f, two), all_equal(0.001f)), 2), kPixels);
  RenderOptions by_error;
  by_error.spp = 1;
  by_error.target_error = 0.1f;
  EXPECT_EQ(with_batches(after_pilot(by_error, all_equal(0.001f)), 2), kPixels);
}

/// Of AO alone, for which a quarter of the pilot pixels goes first.
SamplePlan after_first_pass(float target, const Variances& variances) {
  RenderOptions options = by_rmse(target);
  options.light = false;
  SamplePlan plan(kSide, kSide, options);
  plan.pilot();
  EXPECT_EQ(with_batches(plan, 2), kPilot / 4);
  EXPECT_TRUE(plan.only_pilot_has_samples());
  plan.after_pilot(variances);
  return plan;
}

TEST(OneBatch, IsTakenFromTheFirstPilotPassWhereItIsByFarEnough) {
  SamplePlan plan = after_first_pass(0.1f, all_equal(0.0024f));
  EXPECT_EQ(with_batches(plan, 1), kPixels - kPilot / 4);
  EXPECT_TRUE(plan.next(all_equal(0.0024f), no_costs).empty());
}

TEST(OneBatch, IsLeftToAllPilotPixelsElsewhere) {
  for (const float variance : {0.0026f, 0.0079f, 0.0081f, 0.0f}) {
    SamplePlan plan = after_first_pass(0.1f, all_equal(variance));
    EXPECT_EQ(with_batches(plan, 2), kPilot) << variance;
    EXPECT_EQ(with_batches(plan, 0), kPixels - kPilot);
    // As it is after a checkpoint, too.
    RenderOptions options = by_rmse(0.1f);
    options.light = false;
    SamplePlan resumed(kSide, kSide, options, plan.samples());
    EXPECT_TRUE(resumed.pilot().empty());
    for (SamplePlan* goes_on : {&plan, &resumed}) {
      goes_on->after_pilot(all_equal(variance));
      const bool one = variance > 0 && variance < 0.008f;
      EXPECT_EQ(with_batches(*goes_on, 1), one ? kPixels - kPilot : 0u) << variance;
      EXPECT_EQ(with_batches(*goes_on, 2), one ? kPilot : kPixels) << variance;
    }
  }
}

TEST(OneBatch, IsJudgedAgainByWhoeverGoesOn) {
  const SamplePlan plan = after_pilot(by_rmse(0.1f), all_equal(0.005f));
  SamplePlan same(kSide, kSide, by_rmse(0.1f), plan.samples());
  EXPECT_TRUE(same.least().empty());
  EXPECT_TRUE(same.next(all_equal(0.005f), no_costs).empty());
  SamplePlan tighter(kSide, kSide, by_rmse(0.05f), plan.samples());
  EXPECT_TRUE(tighter.least().empty());
  EXPECT_FALSE(tighter.next(all_equal(0.005f), no_costs).empty());
  EXPECT_EQ(with_batches(tighter, 2), kPixels);
  SamplePlan more(kSide, kSide, by_rmse(0.1f, 4 * DAPPLE_SAMPLE_BATCH), plan.samples());
  EXPECT_FALSE(more.least().empty());
  EXPECT_EQ(with_batches(more, 4), kPixels);
}

// Noise on a slope: neighbours differ by both.
TEST(OneBatch, VariancesOfSinglesAreAsLargeAsThoseOfTheOthers) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0.0f, 0.1f);
  std::vector<std::uint32_t> samples(kPixels, DAPPLE_SAMPLE_BATCH);
  std::vector<BatchMoments> moments(kPixels);
  for (std::size_t p = 0; p < kPixels; ++p) {
    const float slope = 0.2f * static_cast<float>(p % kSide);
    const float first = slope + noise(random), second = slope + noise(random);
    const bool is_pilot = p % 16 < 4 && p / kSide % 16 < 4;  // squares of them
    samples[p] = is_pilot ? 2 * DAPPLE_SAMPLE_BATCH : DAPPLE_SAMPLE_BATCH;
    moments[p] = is_pilot ? BatchMoments{0.5f * (first + second), first * first + second * second}
                          : BatchMoments{first, first * first};
  }
  const auto of = [&](std::size_t p) { return moments[p]; };
  std::vector<float> variances = batch_variances(samples, kSide, of);
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (std::size_t p = 0; p < kPixels; ++p)
    if (samples[p] == DAPPLE_SAMPLE_BATCH) variances[p] = 1;  // which nobody may look at
  add_variances_of_single_batches(samples, kSide, of, variances);
  for (std::size_t p = 0; p < kPixels; ++p) {
    const bool single = samples[p] == DAPPLE_SAMPLE_BATCH;
    sum[single] += variances[p];
    count[single] += 1;
  }
  EXPECT_NEAR(sum[0] / count[0], 0.01, 0.001);
  EXPECT_NEAR(sum[1] / count[1], sum[0] / count[0], 0.001);
}

RenderOptions draft() {
  RenderOptions options = by_rmse(0.09f);
  options.width = options.height = 96;
  options.light = false;
  return options;
}

const std::vector<float>& channel(const RenderResult& result, const char* name) {
  return result.film.find(name)->pixels;
}

TEST(OneBatch, ADraftIsAsFarFromTheTruthAsWasAskedAndSaysSo) {
  const Scene scene = make_procedural("scene:tree?leaves=5000");
  const RenderOptions options = draft();
  const RenderResult result = render(scene, options);
  const auto& samples = channel(result, "samples");
  EXPECT_EQ(*std::min_element(samples.begin(), samples.end()), DAPPLE_SAMPLE_BATCH / 2)
      << "two depths";
  EXPECT_EQ(*std::max_element(samples.begin(), samples.end()), DAPPLE_SAMPLE_BATCH);
  RenderOptions many = options;
  many.target_rmse = 0;
  many.spp = 512;
  many.footprint_spp = footprint_samples(options);
  const RenderResult truth = render(scene, many);
  const auto &a = channel(result, "ao.R"), &b = channel(truth, "ao.R"),
             &e = channel(result, "error.ao");
  double square = 0, predicted = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    square += (a[p] - b[p]) * (a[p] - b[p]);
    predicted += e[p] * e[p];
  }
  const double rmse = std::sqrt(square / static_cast<double>(a.size()));
  const double estimate = std::sqrt(predicted / static_cast<double>(a.size()));
  EXPECT_NEAR(result.statistics.rmse.at("ao"), estimate, 1e-6);
  EXPECT_LT(rmse, 0.09);
  EXPECT_LT(rmse, 1.2 * estimate);
  EXPECT_GT(rmse, 0.6 * estimate);
}

TEST(OneBatch, AnInterruptedDraftEndsWithTheSameBits) {
  const Scene scene = make_procedural("scene:tree?leaves=5000");
  const std::string path = (std::filesystem::path(testing::TempDir()) / "one_batch.ckpt").string();
  std::filesystem::remove(path);
  const RenderResult whole = render(scene, draft());
  for (int calls = 0; calls <= 1; ++calls) {  // before the pilot samples, and after
    int left = calls;
    RenderControl control;
    control.checkpoint = path;
    control.stop = [&] { return --left < 0; };
    EXPECT_TRUE(render(scene, draft(), control).interrupted) << calls;
    RenderControl on;
    on.resume = path;
    const RenderResult resumed = render(scene, draft(), on);
    for (const char* name : {"ao.R", "samples", "error.ao"})
      EXPECT_EQ(channel(resumed, name), channel(whole, name)) << name << " after " << calls;
    std::filesystem::remove(path);
  }
}

}  // namespace
}  // namespace dapple
