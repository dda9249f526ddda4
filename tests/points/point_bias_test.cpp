// The bias that measure_points() reports: it is there for each quantity that is corrected, changes
// no value, and chooses footprints.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "dapple/points.hpp"

namespace dapple {
namespace {

struct Given {
  std::vector<V3f> points, normals;
};

Given points_in_tree() {
  std::mt19937 bits(3);
  std::uniform_real_distribution<float> uniform(-2, 2);
  Given given;
  for (int i = 0; i < 600; ++i) {
    given.points.emplace_back(uniform(bits), 2 + uniform(bits), uniform(bits));
    given.normals.emplace_back(0, 1, 0);
  }
  return given;
}

PointResult measured(const PointOptions& options) {
  const Given given = points_in_tree();
  return measure_points(make_procedural("scene:tree?leaves=3000"), given.points, given.normals,
                        options);
}

TEST(PointBias, EveryCorrectedQuantityHasOneAndNoValueDependsOnIt) {
  PointOptions options;
  options.rays = 64;
  options.report_bias = 0;
  const PointResult none = measured(options);
  EXPECT_TRUE(none.bias.empty());
  options.report_bias = 0.1f;
  const PointResult some = measured(options);
  ASSERT_EQ(some.bias.size(), 2u);
  EXPECT_GT(some.bias.at("ao").error, 0);
  EXPECT_GT(some.bias.at("ao").share, 0);
  EXPECT_EQ(some.bias.count("sky_view_factor"), 1u);
  ASSERT_EQ(some.columns.size(), none.columns.size());
  for (std::size_t c = 0; c < some.columns.size(); ++c)
    EXPECT_EQ(some.columns[c].values, none.columns[c].values);
  options.estimator = Estimator::exact;
  EXPECT_TRUE(measured(options).bias.empty());
}

TEST(PointBias, ALightCalledSunIsNotTheSuns) {
  const Given given = points_in_tree();
  Scene scene = make_procedural("scene:tree?leaves=3000");
  Light sun;
  sun.name = "sun";
  sun.kind = LightKind::sun;
  sun.angular_radius = 0.1f;
  scene.lights = {sun};
  PointOptions options;
  options.rays = 64;
  options.ao = options.sky_view_factor = false;
  options.lights = true;
  for (int i = 0; i < 100; ++i) {
    const float angle = 0.05f * static_cast<float>(i);
    options.suns.push_back({V3f(std::sin(angle), 1, std::cos(angle)).normalized(), 10});
  }
  const PointResult found = measure_points(scene, given.points, given.normals, options);
  EXPECT_EQ(found.bias.size(), 2u);
  EXPECT_EQ(found.bias.count("light.sun"), 1u);
  EXPECT_EQ(found.bias.count("sun"), 1u);
}

TEST(PointBias, TheNoteAndTheReportAgree) {
  PointOptions options;
  options.rays = 64;
  options.sky_view_factor = false;
  options.footprint = 64;
  const PointResult result = measured(options);
  const Bias& bias = result.bias.at("ao");
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes.back().find(bias.mean < 0 ? "too dark" : "too light"), std::string::npos);
  EXPECT_NE(result.notes.back().find(fmt::format("{:.4f}", std::fabs(bias.mean))),
            std::string::npos)
      << result.notes.back();
}

TEST(PointBias, MaxBiasChoosesAFootprint) {
  PointOptions options;
  options.rays = 64;
  options.max_bias = 1;
  EXPECT_EQ(measured(options).footprint, options.footprint);
  options.max_bias = 1e-7f;
  const PointResult exact = measured(options);
  EXPECT_EQ(exact.footprint, 0);
  EXPECT_TRUE(exact.bias.empty());
}

}  // namespace
}  // namespace dapple
