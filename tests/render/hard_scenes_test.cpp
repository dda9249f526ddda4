// Prefiltered pictures of 256 samples of scenes that leak or darken where opacities of nodes are
// multiplied (support/scenes/hard_scenes.hpp), against exact ones of the same samples: mean, RMSE,
// RMSE of the worst window of 32x32 pixels, and what small steps of the camera change. With the
// footprint that a render chooses, and with the default one, since a smaller one hides faults of
// the model.
#include "support/scenes/hard_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/compare_films.hpp"
#include "support/scenes/camera_steps.hpp"

namespace dapple {
namespace {

using namespace hard_scenes;

/// The largest differences from exact rays that a layer may have.
struct Limits {
  double mean, rmse, window;
};

/// Of the layer "ao" or of the only light, which counts relative to `largest`, its largest value
/// without occlusion.
void expect_close(const Film& prefiltered, const Film& exact, const std::string& layer,
                  const Limits& limits, double largest = 1) {
  const Comparison compared = compare_test::compared(prefiltered, exact);
  const auto is_layer = [&](const LayerDifference& one) { return one.layer == layer; };
  const auto found = std::find_if(compared.layers.begin(), compared.layers.end(), is_layer);
  ASSERT_NE(found, compared.layers.end()) << "no layer " << layer;
  EXPECT_GT(found->mean_b, 0.001 * largest) << "something is seen";
  EXPECT_LE(std::fabs(found->mean_difference) / largest, limits.mean);
  EXPECT_LE(found->rmse / largest, limits.rmse);
  EXPECT_LE(found->window_rmse / largest, limits.window);
}

/// `chosen`: with the footprint that the render chooses; `kept`: with the default one.
void expect_close(const HardScene& hard, const std::string& layer, const Limits& chosen,
                  const Limits& kept, double largest = 1) {
  RenderOptions options = picture_of(layer);
  Renderer renderer;  // keeps the BVH
  options.estimator = Estimator::exact;
  const Film exact = renderer.render(hard.scene, options).film;
  options.estimator = Estimator::prefiltered;
  for (const bool chooses : {true, false}) {
    if (!chooses) options.max_bias = 0.0f;
    const RenderResult result = renderer.render(hard.scene, options);
    const float footprint = result.statistics.footprint;
    SCOPED_TRACE(testing::Message()
                 << layer << ", footprint " << footprint << (chooses ? " by choice" : " as given"));
    if (!chooses) {
      EXPECT_EQ(footprint, kDefaultFootprint);
    }
    expect_close(result.film, exact, layer, chooses ? chosen : kept, largest);
  }
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
constexpr Limits kSame{1e-5, 1e-5, 1e-5};

TEST(HardScenes, AnOpenTunnelIsExact) {
  const HardScene hard = open_tunnel();
  expect_close(hard, "ao", kSame, kSame);
  expect_close(hard, "light.lamp", kSame, kSame, std::acos(-1.0));
}

TEST(HardScenes, ARoomWithOneWindowIsExact) {
  expect_close(room_with_one_window(), "ao", kSame, kSame);
}

// Slats are regular, so what one of them lets through the next one stops or not for all rays alike:
// with the default footprint the opacities of nodes, which are independent, are 0.005 too dark. The
// pilot takes a smaller one.
TEST(HardScenes, BlindsAreNearExact) {
  expect_close(blinds(), "ao", {0.003, 0.006, 0.009}, {0.006, 0.012, 0.02});
}

TEST(HardScenes, AHedgeOfAlignedBladesIsNearExact) {
  expect_close(hedge(), "ao", {0.004, 0.007, 0.012}, {0.0035, 0.0065, 0.0105});
}

TEST(HardScenes, WallsOfLeavesWithALampBetweenAreNearExact) {
  const HardScene hard = walls_of_leaves();
  expect_close(hard, "ao", {0.003, 0.012, 0.016}, {0.0015, 0.0105, 0.0135});
  expect_close(hard, "light.lamp", {0.001, 0.004, 0.01}, {0.0002, 0.0005, 0.0008}, std::acos(-1.0));
}

TEST(HardScenes, APlateOfTenThousandHolesIsNearExact) {
  expect_close(plate_of_ten_thousand_holes(), "ao", {0.002, 0.005, 0.005},
               {0.0004, 0.0014, 0.0026});
}

TEST(HardScenes, GrassAtAGrazingAngleIsNearExact) {
  expect_close(grass_at_a_grazing_angle(), "ao", {0.002, 0.005, 0.005}, {0.001, 0.002, 0.003});
}

// The camera sees their tips, and boxes around tips are denser below: the mean was -0.0156 before
// footprints kept clear of the line of sight.
TEST(HardScenes, TipsOfGrassAreNearExactInFewSamples) {
  RenderOptions options = picture_of("ao");
  options.width = options.height = 128;
  options.spp = 16;
  ASSERT_FALSE(chooses_footprint(options));
  const Scene grass = grass_at_a_grazing_angle().scene;
  const Film prefiltered = render(grass, options).film;
  options.estimator = Estimator::exact;
  expect_close(prefiltered, render(grass, options).film, "ao", {0.012, 0.014, 0.025});
}

/// The largest change of the mean of a block of 16x16 pixels in seven steps of the camera.
double largest_step(const Scene& scene, float step_m, const std::string& layer,
                    Estimator estimator) {
  RenderOptions options = picture_of(layer);
  options.spp = 64;
  options.estimator = estimator;
  return camera_steps::largest_step(camera_steps::frames(scene, step_m, layer, options, 8));
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
