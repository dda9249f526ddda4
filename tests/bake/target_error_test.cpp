// How many values of a bake have a larger error than the target, because their rays are at the
// maximum.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dapple/bake.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

using namespace scene_test;

TEST(BakeTarget, MissingValuesAreFewerWithMoreRaysAndNoneWithEnough) {
  const Scene tree = make_procedural("scene:tree?leaves=200");
  BakeOptions options;
  options.target_error = 0.05f;
  const auto found_with = [&](int rays) {
    options.rays = rays;
    return bake(tree, options).statistics.ao_target;
  };
  const TargetStatistics few = found_with(8), more = found_with(128), enough = found_with(8192);
  EXPECT_GT(few.above, few.values / 4);
  EXPECT_LE(few.above, few.values);
  EXPECT_GE(more.values, few.values) << "a value may have its first samples inside a twig";
  EXPECT_LE(more.values, few.values + few.values / 100);
  EXPECT_GT(more.above, 0u);
  EXPECT_LT(more.above, few.above / 2);
  EXPECT_EQ(enough.above, 0u);
}

// Two samples that agree by chance say nothing of the error. Below the plate AO is 0.6 to 0.8.
TEST(BakeTarget, TexelsWhoseFirstSamplesAgreeByChanceGetMore) {
  Scene floor, plate;
  for (Scene* scene : {&floor, &plate}) scene->materials.resize(1);
  place(floor, square_mesh(1, 0, 1, 0));
  place(plate, square_mesh(1, 0.7f, 1, 0));
  BakeOptions options;
  options.vertices = false;
  options.texture = true;
  options.texture_size = 64;
  options.sides = BakeSides::front;
  options.estimator = Estimator::exact;
  options.rays = 2048;
  options.target_error = 0;
  const BakedTexture truth = bake(floor, options, {}, {plate}).texture;
  constexpr float kTarget = 0.02f;
  options.rays = 16384;
  options.target_error = kTarget;
  const BakedTexture found = bake(floor, options, {}, {plate}).texture;
  std::size_t covered = 0, far = 0;
  for (std::size_t i = 0; i < truth.ao.size(); ++i) {
    if (truth.ao[i] > 0.95f) continue;  // outside of the chart
    ++covered;
    if (std::abs(found.ao[i] - truth.ao[i]) > 4 * kTarget) ++far;
  }
  EXPECT_GT(covered, 2000u);
  EXPECT_LT(far, covered / 500) << "of " << covered;
}

// Samples of a surface are spread over it: by themselves they tell a larger error than there is.
TEST(BakeTarget, ReportedErrorsAreThoseThatThereAre) {
  Scene floor, plate;
  for (Scene* scene : {&floor, &plate}) scene->materials.resize(1);
  place(floor, square_mesh(8, 0, 64, 0));
  place(plate, square_mesh(3, 1, 1, 0));
  const Scene tree = make_procedural("scene:tree?leaves=2000");
  for (const bool is_tree : {false, true}) {
    BakeOptions options;
    options.sides = is_tree ? BakeSides::max : BakeSides::front;
    options.estimator = Estimator::exact;
    const auto bake_it = [&] {
      return is_tree ? bake(tree, options) : bake(floor, options, {}, {plate});
    };
    const BakeResult found = bake_it();
    options.target_error = 0;
    options.rays = 2048;
    options.seed = 1;
    const BakeResult truth = bake_it();
    double squares = 0, values = 0;
    for (std::size_t m = 0; m < truth.meshes.size(); ++m)
      for (std::size_t v = 0; v < truth.meshes[m].ao.size(); ++v, ++values)
        squares += std::pow(double{found.meshes[m].ao[v]} - truth.meshes[m].ao[v], 2);
    const BakeStatistics& s = found.statistics;
    const double error = std::sqrt(squares / values);
    const double reported = std::sqrt(s.squared_errors / static_cast<double>(s.sampled_values));
    std::printf("%s: error %.4f, reported %.4f\n", is_tree ? "tree" : "floor", error, reported);
    EXPECT_NEAR(reported / error, 1, 0.12);
  }
}

TEST(BakeTarget, MissingValuesDoNotDependOnThreads) {
  const Scene tree = make_procedural("scene:tree?leaves=2000");
  BakeOptions options;
  options.target_error = 0.05f;
  options.rays = 128;
  const BakeStatistics many = bake(tree, options).statistics;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const BakeStatistics few = bake(tree, options).statistics;
  EXPECT_GT(many.ao_target.above, 0u);
  EXPECT_EQ(few.ao_target.above, many.ao_target.above);
  EXPECT_EQ(few.notes, many.notes);
}

TEST(BakeTarget, MissingValuesAreToldFromAHalfPercentOn) {
  const Scene tree = make_procedural("scene:tree?leaves=200");
  BakeOptions options;
  options.target_error = 0.08f;
  std::size_t told = 0, untold = 0;
  for (options.rays = 32; options.rays <= 192; options.rays += 32) {
    const BakeStatistics found = bake(tree, options).statistics;
    const TargetStatistics& target = found.ao_target;
    const bool is_told = std::any_of(
        found.notes.begin(), found.notes.end(),
        [](const std::string& note) { return note.find("--target-error") != std::string::npos; });
    EXPECT_EQ(is_told, 200 * target.above >= target.values) << target.above;
    if (is_told) ++told;
    if (!is_told && target.above > 0) ++untold;
  }
  EXPECT_GT(told, 0u);
  EXPECT_GT(untold, 0u);
}

TEST(BakeTarget, WhatNoTriangleUsesIsNoValueAndEachTexelIsOne) {
  Scene scene = make_procedural("scene:cube?divisions=1");
  const std::size_t vertices = scene.meshes.at(0).positions.size();
  BakeOptions options;
  options.rays = 8;
  options.target_error = 1e-4f;
  const TargetStatistics before = bake(scene, options).statistics.ao_target;
  scene.meshes[0].positions.emplace_back(9.0f, 9.0f, 9.0f);
  const TargetStatistics after = bake(scene, options).statistics.ao_target;
  EXPECT_GT(before.values, 7u);
  EXPECT_LE(before.values, vertices);
  EXPECT_EQ(before.above, before.values);
  EXPECT_EQ(after.values, before.values);
  EXPECT_EQ(after.above, before.above);
  options.vertices = false;
  options.texture = true;
  options.texture_size = 64;
  const BakeStatistics texture = bake(scene, options).statistics;
  EXPECT_EQ(texture.ao_target.values, texture.texels);
  EXPECT_EQ(texture.ao_target.above, texture.texels);
}

TEST(BakeTarget, ValuesOfFixedRaysHaveNone) {
  BakeOptions options;
  options.target_error = 0;
  options.rays = 8;
  const BakeStatistics found = bake(make_procedural("scene:tree?leaves=100"), options).statistics;
  EXPECT_EQ(found.ao_target.values, 0u);
}

}  // namespace
}  // namespace dapple
