// The bias that a bake reports of itself: it changes no value, agrees with exact values, and
// chooses footprints.
#include "bake/bake_bias.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "dapple/bake.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

BakeOptions few_rays() {
  BakeOptions options;
  options.rays = 64;
  options.target_error = 0;
  return options;
}

Scene tree() { return make_procedural("scene:tree?leaves=3000"); }

double mean_ao(const BakeResult& baked) {
  double sum = 0, count = 0;
  for (const BakedMesh& mesh : baked.meshes)
    for (const float value : mesh.ao) {
      sum += double{value};
      count += 1;
    }
  return sum / count;
}

TEST(BakeBias, NoShareChangesAValue) {
  for (const float target : {0.0f, 0.06f}) {
    BakeOptions options = few_rays();
    options.target_error = target;
    options.report_bias = 0;
    const BakeResult none = bake(tree(), options);
    EXPECT_TRUE(none.statistics.bias.empty());
    options.report_bias = 1;
    const BakeResult all = bake(tree(), options);
    ASSERT_EQ(all.meshes.size(), none.meshes.size());
    for (std::size_t m = 0; m < all.meshes.size(); ++m)
      EXPECT_EQ(all.meshes[m].ao, none.meshes[m].ao);
    EXPECT_EQ(all.statistics.bias.count("ao"), 1u);
  }
}

TEST(BakeBias, ItAgreesWithExactValues) {
  BakeOptions options = few_rays();
  options.sides = BakeSides::front;
  options.at_vertices = true;  // each value is one sample, so that both have equal weights
  options.footprint = 16;
  options.report_bias = 1;
  const Scene cloud = make_procedural("scene:cloud?leaves=3000");  // nothing hides in closed wood
  const BakeResult prefiltered = bake(cloud, options);
  options.estimator = Estimator::exact;
  const BakeResult exact = bake(cloud, options);
  EXPECT_TRUE(exact.statistics.bias.empty());
  const Bias& bias = prefiltered.statistics.bias.at("ao");
  // Values of vertex groups count once in the bias, and by vertex here.
  EXPECT_NEAR(bias.mean, mean_ao(prefiltered) - mean_ao(exact), 2 * bias.error + 0.002);
  EXPECT_GT(bias.error, 0);
}

// In one batch: of later ones the clock decides. The second set of samples makes no value.
TEST(BakeBias, AllSamplesThatMakeValuesAreComparedIfAskedFor) {
  BakeOptions options = few_rays();
  options.report_bias = 1;
  const BakeResult baked = bake(tree(), options);
  EXPECT_EQ(baked.statistics.bias.at("ao").share, 1);
}

TEST(BakeBias, MaxBiasChoosesAFootprint) {
  BakeOptions options = few_rays();
  options.max_bias = 1;
  EXPECT_EQ(bake(tree(), options).statistics.footprint, options.footprint);
  options.max_bias = 1e-7f;
  options.report_bias = 1;
  const BakeStatistics exact = bake(tree(), options).statistics;
  EXPECT_EQ(exact.footprint, 0);
  EXPECT_TRUE(exact.bias.empty()) << "there is nothing to compare";
  options.max_bias = 2;
  EXPECT_THROW(bake(tree(), options), Error);
}

// The first blocks of 64 samples that are chosen as 2 % of all are 33, 88 and 122.
TEST(BakeBias, OneBlockTellsNoErrorAndIsNotReported) {
  const auto report_of = [](std::size_t samples) {
    BakeBias bias(0.02);
    const auto trace = [](std::span<const SurfaceSample> all, std::span<const std::uint32_t>,
                          const Placements&, int, std::uint32_t) {
      TracedSamples traced;
      traced.front.resize(all.size(), SideValue{0.5f, V3f(0, 0, 0)});
      traced.back = traced.front;
      return traced;
    };
    const TraceSamples traced = bias.with({"ao", trace, trace, trace});
    const std::vector<SurfaceSample> all(samples);
    traced(all, std::vector<std::uint32_t>(samples), Placements{}, 8, 1);
    return bias.report();
  };
  EXPECT_TRUE(report_of(64 * 33).empty()) << "none is chosen";
  EXPECT_TRUE(report_of(64 * 34).empty()) << "one is";
  const auto two = report_of(64 * 89);
  ASSERT_EQ(two.count("ao"), 1u);
  EXPECT_EQ(two.at("ao").mean, 0);
  EXPECT_NEAR(two.at("ao").error, 1.0 / (2 * 64 * 8), 1e-9) << "of equal values not 0 either";
}

/// A tracer whose samples have this value and which takes a time.
TraceSamples slow_tracer(const float& value, int milliseconds) {
  return [&value, milliseconds](std::span<const SurfaceSample> all, std::span<const std::uint32_t>,
                                const Placements&, int, std::uint32_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    TracedSamples traced;
    traced.front.resize(all.size(), SideValue{value, V3f(0, 0, 0)});
    traced.back = traced.front;
    return traced;
  };
}

// Comparing takes twenty times the time of tracing, so that of a second mesh less is compared. A
// tenth of the samples, those of the first, has a bias of 0.1, the others have 0.3.
TEST(BakeBias, MeshesOfWhichMoreWasComparedDoNotCountMore) {
  BakeBias bias(1);
  float value = 0.1f;
  const float none = 0;
  for (std::size_t blocks : {1000, 9000}) {
    const TraceSamples traced =
        bias.with({"ao", slow_tracer(value, 2), slow_tracer(value, 20), slow_tracer(none, 20)});
    const std::vector<SurfaceSample> all(64 * blocks);
    traced(all, std::vector<std::uint32_t>(all.size()), Placements{}, 8, 1);
    value = 0.3f;
  }
  const Bias found = bias.report().at("ao");
  EXPECT_LT(found.share, 0.2) << "most of the first and few of the others";
  EXPECT_NEAR(found.mean, 0.28, 0.01) << "0.11 to 0.13 if all of them counted the same";
}

// The second block of samples lies inside closed geometry.
TEST(BakeBias, ABlockInsideClosedGeometryTellsNoError) {
  BakeBias bias(1);
  const float value = 0.5f, none = 0;
  const TraceSamples exact = [trace = slow_tracer(none, 0)](auto samples, auto placement,
                                                            const Placements& all, int rays,
                                                            std::uint32_t hash) {
    TracedSamples traced = trace(samples, placement, all, rays, hash);
    traced.inside.assign(samples.size(), 0);
    std::fill(traced.inside.begin() + 64, traced.inside.end(), 1);
    return traced;
  };
  const std::vector<SurfaceSample> all(128);
  bias.with({"ao", slow_tracer(value, 0), slow_tracer(value, 0), exact})(
      all, std::vector<std::uint32_t>(128), Placements{}, 8, 1);
  EXPECT_TRUE(bias.report().empty());
}

TEST(BakeBias, LightsHaveOne) {
  BakeOptions options = few_rays();
  options.light = true;
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.direction = V3f(0.3f, -0.9f, 0.2f).normalized();
  sun.angular_radius = 0.05f;
  options.lights = {sun};
  options.report_bias = 1;
  const BakeResult baked = bake(tree(), options);
  ASSERT_EQ(baked.statistics.bias.count("light"), 1u);
  EXPECT_LT(std::fabs(baked.statistics.bias.at("light").mean), 0.05);
}

}  // namespace
}  // namespace dapple
