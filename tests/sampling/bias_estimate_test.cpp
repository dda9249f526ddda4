// The estimate of a bias: its mean, its standard error and the RMSE of tiles, of made-up
// differences whose truth is known; and which samples are traced exactly.
#include "sampling/bias_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sampling/exact_samples.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kTiles = 64, kUnits = 16;
constexpr double kValues = 50;

/// Units of tiles with biases -amplitude and amplitude in turn plus `mean`, and normal noise of
/// standard deviation `noise` per unit's mean.
std::vector<BiasUnit> made_up(double mean, double amplitude, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<BiasUnit> units;
  for (std::uint32_t tile = 0; tile < kTiles; ++tile)
    for (std::uint32_t unit = 0; unit < kUnits; ++unit) {
      const double bias = mean + (tile % 2 ? amplitude : -amplitude);
      units.push_back({tile, kValues, kValues * (bias + normal(random))});
    }
  return units;
}

TEST(BiasEstimate, WithoutNoiseItIsTheBiasItself) {
  const Bias bias = estimate_bias(made_up(-0.01, 0.004, 0, 1), 0.02);
  EXPECT_NEAR(bias.mean, -0.01, 1e-12);
  EXPECT_NEAR(bias.error, 0, 1e-10);
  EXPECT_NEAR(bias.tile_rmse, std::hypot(0.01, 0.004), 1e-12);
  EXPECT_EQ(bias.share, 0.02);
}

TEST(BiasEstimate, TheErrorCoversTheTruthNineteenTimesOfTwenty) {
  int covered = 0;
  constexpr int kTrials = 400;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const Bias bias = estimate_bias(made_up(-0.002, 0, 0.05, seed), 1);
    covered += std::fabs(bias.mean + 0.002) <= 2 * bias.error ? 1 : 0;
    EXPECT_NEAR(bias.error, 0.05 / std::sqrt(kTiles * kUnits), 0.0003);
  }
  EXPECT_GT(covered, 0.92 * kTrials);
  EXPECT_LT(covered, 0.985 * kTrials);
}

TEST(BiasEstimate, TheRmseOfTilesHasNoNoise) {
  double squares = 0, below_limit = 0;
  constexpr int kTrials = 200;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const Bias bias = estimate_bias(made_up(0, 0.02, 0.05, seed), 1);
    squares += bias.tile_rmse * bias.tile_rmse / kTrials;
    below_limit += bias.tile_rmse_limit > 0.02 ? 1 : 0;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.02, 0.0005);  // with the noise it would be 0.0236
  EXPECT_GT(below_limit, 0.93 * kTrials);
}

TEST(BiasEstimate, NothingComparedIsNoBias) {
  const Bias bias = estimate_bias({}, 0);
  EXPECT_EQ(bias.mean, 0);
  EXPECT_EQ(bias.tile_rmse_limit, 0);
}

TEST(BiasEstimate, TheTextHasTheMeanItsErrorAndTheRmse) {
  EXPECT_EQ(bias_text({-0.0021, 0.0004, 0.0035, 0.005, 0.02}),
            "-0.0021 +- 0.0004, RMSE over tiles 0.0035");
}

TEST(ErrorOfMeanSquare, IsThatOfTheMeanOrOfTheTiles) {
  EXPECT_NEAR(error_of_mean_square({-0.01, 0.002, 0, 0, 1}), 0.002 * 0.022, 1e-12);
  EXPECT_NEAR(error_of_mean_square({0, 0.001, 0.01, 0.02, 1}), 0.5 * (0.0004 - 0.0001), 1e-12);
}

TEST(NoiseTarget, TheSquaresAddUpToTheTargetsSquare) {
  EXPECT_FLOAT_EQ(noise_target(0.05f, 0.03), 0.04f);
  EXPECT_FLOAT_EQ(noise_target(0.05f, 0), 0.05f);
  EXPECT_FLOAT_EQ(noise_target(0.05f, 0.06), 0.025f);  // half: more would never end
}

TEST(ExactSamples, EachPartOfAPictureHasItsShare) {
  for (const double share : {0.02, 0.1}) {
    const ExactSamples samples(share);
    for (std::uint32_t corner = 0; corner < 512; corner += 128) {
      int chosen = 0;
      for (std::uint32_t y = 0; y < 128; y += kBiasUnit)
        for (std::uint32_t x = 0; x < 128; x += kBiasUnit)
          for (std::uint32_t s = 0; s < 16; ++s) chosen += samples.has(corner + x, y, s) ? 1 : 0;
      EXPECT_NEAR(chosen, share * 4096, 0.05 * 4096 * share + 4) << corner;
    }
    int of_one = 0;
    for (std::uint32_t s = 0; s < 5000; ++s) of_one += samples.has(77, 33, s) ? 1 : 0;
    EXPECT_NEAR(of_one, share * 5000, 3);
  }
}

TEST(ExactSamples, PixelsOfAUnitAreChosenTogetherAndMoreShareKeepsTheSamples) {
  const ExactSamples few(0.02), many(0.1);
  for (std::uint32_t s = 0; s < 2000; ++s) {
    EXPECT_EQ(few.has(16, 24, s), few.has(23, 31, s));
    EXPECT_LE(few.has(16, 24, s), many.has(16, 24, s));
  }
}

}  // namespace
}  // namespace dapple
