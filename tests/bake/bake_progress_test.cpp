// The fraction that a bake shows: 1 tells that all samples are traced, and nothing else does.
#include "bake/bake_progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dapple/bake.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

TEST(BakeProgress, ShowsOneOnlyWhenItIsFinished) {
  std::vector<double> shown;
  RenderControl control;
  control.progress = [&](double fraction) { shown.push_back(fraction); };
  BakeProgress progress(100, control);
  progress.add(60);
  progress.add(60);  // more than expected
  progress.expect(400);
  progress.add(20);
  ASSERT_EQ(shown.size(), 3u);
  EXPECT_EQ(shown[0], 0.6);
  EXPECT_GT(shown[1], 0.99);
  EXPECT_LT(shown[1], 1);
  EXPECT_EQ(shown[2], shown[1]) << "it goes back nowhere";
  progress.finish();
  EXPECT_EQ(shown.back(), 1);
}

// With a target it is not known in advance how many samples there will be.
TEST(BakeProgress, EndsWithOneWhetherRaysAreFewerOrMoreThanExpected) {
  const Scene tree = make_procedural("scene:tree?leaves=200");
  for (const float target : {0.0f, 0.02f, 0.3f}) {
    SCOPED_TRACE(target);
    BakeOptions options;
    options.target_error = target;
    std::vector<double> shown;
    RenderControl control;
    control.progress = [&](double fraction) { shown.push_back(fraction); };
    bake(tree, options, control);
    ASSERT_GT(shown.size(), 1u);
    EXPECT_EQ(shown.back(), 1);
    EXPECT_EQ(std::count(shown.begin(), shown.end(), 1.0), 1);
    EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  }
}

TEST(BakeProgress, DoesNotShowOneIfItIsStopped) {
  BakeOptions options;
  std::vector<double> shown;
  RenderControl control;
  control.progress = [&](double fraction) { shown.push_back(fraction); };
  control.stop = [asked = 0]() mutable { return ++asked > 2; };
  ASSERT_TRUE(bake(make_procedural("scene:tree?leaves=200"), options, control).interrupted);
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(std::count(shown.begin(), shown.end(), 1.0), 0);
}

}  // namespace
}  // namespace dapple
