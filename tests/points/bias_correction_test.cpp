// BiasCorrection: what it takes out, what it leaves alone, and how sure it is.
#include "points/bias_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace dapple {
namespace {

double corrected(const BiasCorrection& bias, double x) {
  return x + bias.change(fall_with_depth(x));
}

TEST(BiasCorrection, DepthsThatAreWrongByOneFactorBecomeRight) {
  std::vector<double> exact, prefiltered;
  for (int i = 0; i <= 100; ++i) {
    const double depth = 0.04 * i;
    exact.push_back(std::exp(-depth));
    prefiltered.push_back(std::exp(-0.96 * depth));
  }
  const BiasCorrection bias(exact, prefiltered);
  for (std::size_t i = 0; i < exact.size(); ++i)  // to the first order in the 4 %
    EXPECT_NEAR(corrected(bias, prefiltered[i]), exact[i], 0.001) << i;
  EXPECT_NE(bias.note("ao").find("too light"), std::string::npos);
}

TEST(BiasCorrection, WhereNothingOrEverythingOccludesNothingChanges) {
  const BiasCorrection bias(std::vector{0.4, 0.5}, std::vector{0.5, 0.6});
  EXPECT_EQ(corrected(bias, 1), 1);
  EXPECT_EQ(corrected(bias, 0), 0);
  EXPECT_LT(corrected(bias, 0.5), 0.45);
  const BiasCorrection none;
  EXPECT_EQ(corrected(none, 0.3), 0.3);
  EXPECT_EQ(none.note("ao"), "");
  EXPECT_EQ(corrected(BiasCorrection(std::vector{1.0, 1.0}, std::vector{1.0, 1.0}), 0.3), 0.3);
}

TEST(BiasCorrection, WhatItLeavesOfSingleValuesIsPartOfTheirError) {
  std::vector<double> exact(100, 0.5), prefiltered(100, 0.6);
  BiasCorrection bias(exact, prefiltered);
  const double fall = fall_with_depth(0.6);
  EXPECT_NEAR(bias.standard_error(fall), 0, 1e-12);
  bias.set_local_bias(0.03);
  EXPECT_NEAR(bias.standard_error(fall), 0.03, 1e-12);
  EXPECT_EQ(bias.standard_error(0), 0);
}

// Noise of 0.05 in 400 differences: the correction's own error must be what repetitions show.
TEST(BiasCorrection, ItsStandardErrorIsThatOfRepetitions) {
  std::mt19937 bits(1);
  std::normal_distribution<double> noise(0, 0.05);
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  double sum = 0, squares = 0, told = 0;
  constexpr int kRepetitions = 400;
  for (int r = 0; r < kRepetitions; ++r) {
    std::vector<double> exact, prefiltered;
    for (int i = 0; i < 400; ++i) {
      prefiltered.push_back(uniform(bits));
      exact.push_back(prefiltered.back() - 0.01 + noise(bits));
    }
    const BiasCorrection bias(exact, prefiltered);
    const double x = corrected(bias, 0.4);
    sum += x;
    squares += x * x;
    told += bias.standard_error(fall_with_depth(0.4)) / kRepetitions;
  }
  const double mean = sum / kRepetitions;
  const double deviation = std::sqrt(squares / kRepetitions - mean * mean);
  EXPECT_NEAR(told / deviation, 1, 0.15);  // 400 repetitions: 4 % at one sigma
}

/// The standard error that is told, over the deviation of repetitions: 100 of `all` points, each
/// with a bias of its own and two values.
double told_over_deviation(std::size_t all) {
  std::mt19937 bits(1);
  std::normal_distribution<double> noise(0, 0.02), own(0.01, 0.05);
  constexpr std::size_t kPoints = 100;
  std::vector<double> biases;
  for (std::size_t p = 0; p < all; ++p) biases.push_back(own(bits));
  double sum = 0, squares = 0, told = 0;
  constexpr int kRepetitions = 400;
  for (int r = 0; r < kRepetitions; ++r) {
    std::shuffle(biases.begin(), biases.end(), bits);
    std::vector<double> exact, prefiltered;
    std::vector<std::uint32_t> points;
    for (std::uint32_t v = 0; v < 2 * kPoints; ++v) {
      points.push_back(v / 2);
      prefiltered.push_back(0.5);
      exact.push_back(0.5 - biases[v / 2] + noise(bits));
    }
    const BiasCorrection bias(exact, prefiltered, points,
                              static_cast<double>(kPoints) / static_cast<double>(all));
    sum += bias.mean_bias();
    squares += bias.mean_bias() * bias.mean_bias();
    told += bias.mean_error() / kRepetitions;
  }
  const double mean = sum / kRepetitions;
  return told / std::sqrt(squares / kRepetitions - mean * mean);
}

TEST(BiasCorrection, ValuesOfOnePointHaveItsBiasInCommon) {
  EXPECT_NEAR(told_over_deviation(10'000), 1, 0.15) << "of few points: without points 0.73";
  EXPECT_NEAR(told_over_deviation(200), 1, 0.15) << "of half of the points";
  EXPECT_NEAR(told_over_deviation(100), 1, 0.15) << "of all points only the noise is left";
}

}  // namespace
}  // namespace dapple
