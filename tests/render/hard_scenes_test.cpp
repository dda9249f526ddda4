// Prefiltered pictures of 256 samples of scenes that leak or darken where opacities of nodes are
// multiplied (support/hard_scenes.hpp), against exact ones of the same samples: mean, RMSE, RMSE of
// the worst window of 32x32 pixels, and what small steps of the camera change.
#include "support/hard_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/compare_films.hpp"

namespace dapple {
namespace {

using namespace hard_scenes;

/// Of the layer "ao" or of the only light, which counts relative to its largest value without
/// occlusion.
LayerDifference difference(const Scene& scene, RenderOptions options, const std::string& layer) {
  const Film prefiltered = render(scene, options).film;
  options.estimator = Estimator::exact;
  const Comparison compared = compare_test::compared(prefiltered, render(scene, options).film);
  for (const LayerDifference& one : compared.layers)
    if (one.layer == layer) return one;
  ADD_FAILURE() << "no layer " << layer;
  return {};
}

LayerDifference difference(const HardScene& hard, const std::string& layer) {
  return difference(hard.scene, picture_of(layer), layer);
}

void expect_close(const LayerDifference& found, double mean, double rmse, double window,
                  double largest = 1) {
  EXPECT_GT(found.mean_b, 0.001 * largest) << "something is seen";
  EXPECT_LE(std::fabs(found.mean_difference) / largest, mean);
  EXPECT_LE(found.rmse / largest, rmse);
  EXPECT_LE(found.window_rmse / largest, window);
}

TEST(HardScenes, AClosedTunnelIsBlackToTheLastBit) {
  const HardScene hard = closed_tunnel();
  RenderOptions options = picture_of("light.lamp");
  options.max_bias = 0.0f;
  // By 0 all rays are exact.
  for (const float footprint : {0.0f, 1.0f, 4.0f, 64.0f, 4096.0f}) {
    options.footprint = footprint;
    const Film film = render(hard.scene, options).film;
    for (const float value : film.find("light.lamp.R")->pixels) ASSERT_EQ(value, 0.0f);
  }
}

/// All that such a scene holds are walls, which are opened: what differs is rounding.
constexpr double kSame = 1e-5;

TEST(HardScenes, AnOpenTunnel) {
  const HardScene hard = open_tunnel();
  expect_close(difference(hard, "ao"), kSame, kSame, kSame);
  expect_close(difference(hard, "light.lamp"), kSame, kSame, kSame, std::acos(-1.0));
}

TEST(HardScenes, ARoomWithOneWindow) {
  expect_close(difference(room_with_one_window(), "ao"), kSame, kSame, kSame);
}

// Slats are regular, so what one of them lets through the next one stops or not for all rays alike:
// with the default footprint the opacities of nodes, which are independent, are 0.005 too dark. The
// pilot takes a smaller one.
TEST(HardScenes, Blinds) { expect_close(difference(blinds(), "ao"), 0.003, 0.006, 0.009); }

TEST(HardScenes, AHedgeOfAlignedBlades) {
  expect_close(difference(hedge(), "ao"), 0.004, 0.007, 0.012);
}

TEST(HardScenes, WallsOfLeavesWithALampBetween) {
  const HardScene hard = walls_of_leaves();
  expect_close(difference(hard, "ao"), 0.003, 0.012, 0.016);
  expect_close(difference(hard, "light.lamp"), 0.001, 0.004, 0.01, std::acos(-1.0));
}

TEST(HardScenes, APlateOfTenThousandHoles) {
  expect_close(difference(plate_of_ten_thousand_holes(), "ao"), 0.002, 0.005, 0.005);
}

TEST(HardScenes, GrassAtAGrazingAngle) {
  expect_close(difference(grass_at_a_grazing_angle(), "ao"), 0.002, 0.005, 0.005);
}

// The camera sees their tips, and boxes around tips are denser below: the mean was -0.0156 before
// footprints kept clear of the line of sight.
TEST(HardScenes, TipsOfGrassInFewSamples) {
  RenderOptions options = picture_of("ao");
  options.width = options.height = 128;
  options.spp = 16;
  expect_close(difference(grass_at_a_grazing_angle().scene, options, "ao"), 0.012, 0.014, 0.025);
}

/// Means of blocks of 16x16 pixels of the first channel of `layer`.
std::vector<double> block_means(const Film& film, const std::string& layer) {
  constexpr std::size_t kSize = 64, kBlock = 16, kBlocks = kSize / kBlock;
  const std::vector<float>& pixels = film.find(layer + ".R")->pixels;
  std::vector<double> means(kBlocks * kBlocks);
  for (std::size_t p = 0; p < pixels.size(); ++p)
    means[p / kSize / kBlock * kBlocks + p % kSize / kBlock] +=
        double{pixels[p]} / (kBlock * kBlock);
  return means;
}

/// The largest change of the mean of a block while the camera moves in seven steps of `step_m`
/// metres along x and z.
double largest_step(Scene scene, float step_m, const std::string& layer, Estimator estimator) {
  RenderOptions options = picture_of(layer);
  options.spp = 64;
  options.estimator = estimator;
  Renderer renderer;  // keeps the BVH
  std::vector<double> before;
  double largest = 0;
  for (int step = 0; step < 8; ++step) {
    const std::vector<double> means = block_means(renderer.render(scene, options).film, layer);
    for (std::size_t b = 0; b < before.size(); ++b)
      largest = std::max(largest, std::fabs(means[b] - before[b]));
    before = means;
    for (const int axis : {0, 2}) scene.cameras[0].to_world[3][axis] += step_m;
  }
  return largest;
}

struct SteppedScene {
  std::string name;
  HardScene (*scene)();
  float step_m;
};

void PrintTo(const SteppedScene& stepped, std::ostream* out) { *out << stepped.name; }

class StepsOfTheCamera : public testing::TestWithParam<SteppedScene> {};

TEST_P(StepsOfTheCamera, MakeNoLeapThatExactRaysDoNotMake) {
  const HardScene hard = GetParam().scene();
  for (const std::string& layer : hard.layers) {
    SCOPED_TRACE(layer);
    const auto step = [&](Estimator estimator) {
      return largest_step(hard.scene, GetParam().step_m, layer, estimator);
    };
    const double largest = layer == "ao" ? 1 : std::acos(-1.0);
    const double exact = step(Estimator::exact);
    EXPECT_GT(exact, 0);
    EXPECT_LE(step(Estimator::prefiltered), exact + 0.01 * largest);
  }
}

INSTANTIATE_TEST_SUITE_P(HardScenes, StepsOfTheCamera,
                         testing::Values(SteppedScene{"OpenTunnel", open_tunnel, 0.03f},
                                         SteppedScene{"Room", room_with_one_window, -0.03f},
                                         SteppedScene{"Blinds", blinds, 0.03f},
                                         SteppedScene{"Hedge", hedge, 0.03f},
                                         SteppedScene{"WallsOfLeaves", walls_of_leaves, 0.03f},
                                         SteppedScene{"Sieve", plate_of_ten_thousand_holes, 0.03f},
                                         SteppedScene{"Grass", grass_at_a_grazing_angle, 0.3f}),
                         [](const auto& chosen) { return chosen.param.name; });

}  // namespace
}  // namespace dapple
