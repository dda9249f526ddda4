// The contest of `dapple-bench rivals`: which times and errors of the contestants count, and the
// time to an error that is derived from them.
#include "rivals/contest.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "accuracy/pixel_statistics.hpp"

namespace dapple::bench {
namespace {

constexpr std::uint32_t kFirstSeed = 1000;

/// A simulated contestant: a run takes effort times the round's seconds. Its two values are off by
/// plus and minus the round's error over the root of the effort.
Contestant by_table(std::string name, std::vector<double> ladder, std::vector<double> seconds,
                    std::vector<double> errors) {
  const auto run = [seconds, errors](double effort, std::uint32_t seed) {
    if (seed < kFirstSeed) return Outcome{1e9, {9, 9}};  // a run that must not be measured
    const double error = errors.at(seed - kFirstSeed) / std::sqrt(effort);
    return Outcome{effort * seconds.at(seed - kFirstSeed), {0.5 + error, 0.5 - error}};
  };
  return {std::move(name), false, true, std::move(ladder), run};
}

Standing standing_of(std::vector<Rung> rungs, bool is_embree = false) {
  return {"one", is_embree, true, std::move(rungs)};
}

Rung rung_of(double effort, double seconds, double rmse) {
  Rung rung;
  rung.effort = effort;
  rung.seconds = seconds;
  rung.rmse = rmse;
  return rung;
}

const Truth kExactTruth{{0.5, 0.5}, 0};

TEST(Contest, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
}

TEST(Contest, TruthOfHalvesIsTheirMeanAndItsVariance) {
  const Truth truth = truth_of_halves({1, 2}, {3, 2});
  EXPECT_EQ(truth.values, (std::vector<double>{2, 2}));
  // On average over the values, halves differ by twice the standard error of their mean.
  EXPECT_DOUBLE_EQ(truth.variance, 0.25 * (4 + 0) / 2);
}

TEST(Contest, SecondsAndErrorsAreMediansOverTheRounds) {
  // The small error of one slow round must not be combined with the seconds of the others.
  const auto standings = hold_contest({by_table("a", {1}, {1, 8, 1}, {0.2, 0.05, 0.2})},
                                      kExactTruth, {.rounds = 3, .stop_below = 0, .progress = {}});
  ASSERT_EQ(standings.size(), 1u);
  ASSERT_EQ(standings[0].rungs.size(), 1u);
  const Rung& rung = standings[0].rungs[0];
  EXPECT_DOUBLE_EQ(rung.seconds, 1);
  EXPECT_DOUBLE_EQ(rung.spread, 7);
  EXPECT_DOUBLE_EQ(rung.rmse, 0.2);
  EXPECT_EQ(rung.rounds, 3);
  EXPECT_NEAR(rung.mean_difference, 0, 1e-15);
}

TEST(Contest, TruthsOwnVarianceIsTakenOutOfErrors) {
  const Truth unsure{{0.5, 0.5}, 0.01};
  const auto standings = hold_contest({by_table("a", {1}, {1}, {0.2})}, unsure,
                                      {.rounds = 1, .stop_below = 0, .progress = {}});
  EXPECT_DOUBLE_EQ(standings[0].rungs[0].rmse, std::sqrt(0.04 - 0.01));
}

TEST(Contest, AContestantStopsBelowTheError) {
  const std::vector<double> ladder{1, 4, 16, 64};
  const auto standings =
      hold_contest({by_table("a", ladder, {1}, {0.2}), by_table("b", ladder, {1}, {0.09})},
                   kExactTruth, {.rounds = 1, .stop_below = 0.06, .progress = {}});
  EXPECT_EQ(standings[0].rungs.size(), 3u);  // 0.2, 0.1, 0.05
  EXPECT_EQ(standings[1].rungs.size(), 2u);  // 0.09, 0.045
}

TEST(Contest, LongEffortsRunTwoRounds) {
  const std::vector<double> seconds(5, 11.0), errors(5, 0.1);
  const auto standings = hold_contest({by_table("a", {1}, seconds, errors)}, kExactTruth,
                                      {.rounds = 5, .stop_below = 0, .progress = {}});
  EXPECT_EQ(standings[0].rungs[0].rounds, 2);
}

TEST(Contest, SecondsToAnErrorLieOnALineBetweenLogarithms) {
  const Standing standing = standing_of({rung_of(1, 1, 0.08), rung_of(4, 4, 0.04)});
  const auto between = time_to_error(standing, 0.08 / std::sqrt(2.0));
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->seconds, 2, 1e-12);
  EXPECT_FALSE(between->extrapolated);
  const auto at_once = time_to_error(standing, 0.1);
  ASSERT_TRUE(at_once);
  EXPECT_EQ(at_once->seconds, 1);
}

TEST(Contest, OnlyNoiseIsExtrapolatedAndNoFartherThanTwice) {
  const Standing noise = standing_of({rung_of(1, 1, 0.08), rung_of(4, 4, 0.04)});
  const auto beyond = time_to_error(noise, 0.025);
  ASSERT_TRUE(beyond);
  EXPECT_TRUE(beyond->extrapolated);
  EXPECT_GT(beyond->seconds, 4);
  EXPECT_FALSE(time_to_error(noise, 0.019));
  // Errors that decrease so slowly approach a bias.
  EXPECT_FALSE(time_to_error(standing_of({rung_of(1, 1, 0.08), rung_of(4, 4, 0.06)}), 0.05));
  EXPECT_FALSE(time_to_error(standing_of({}), 0.05));
}

TEST(Contest, BestEmbreeIsTheFastestToReachTheError) {
  const std::vector<Standing> standings{
      standing_of({rung_of(1, 0.1, 0.5)}, true),  // never reaches the error
      standing_of({rung_of(1, 3, 0.01)}, true),   //
      standing_of({rung_of(1, 2, 0.02)}, true),   //
      standing_of({rung_of(1, 0.5, 0.001)})};     // not Embree
  const auto best = best_embree(standings, 0.02);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->seconds, 2);
  EXPECT_FALSE(best_embree({standings[3]}, 0.02));
}

TEST(Contest, ExactContestantsWhoseMeanIsOffAreNamed) {
  Rung off = rung_of(16, 1, 0.01);
  off.mean_difference = 0.01;
  off.mean_difference_error = 0.001;
  const double black = 1e-3;
  EXPECT_NE(disagreements({standing_of({off})}, black).find("one: the mean is +0.01000"),
            std::string::npos);
  Standing biased = standing_of({off});
  biased.is_exact = false;
  EXPECT_EQ(disagreements({biased}, black), "");
  off.mean_difference = 0.004;  // within four standard errors and half of the cut-off
  EXPECT_EQ(disagreements({standing_of({off})}, black), "");
}

}  // namespace
}  // namespace dapple::bench
