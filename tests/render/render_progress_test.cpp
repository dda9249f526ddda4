// The fraction that a render shows: 1 tells that all samples are traced, and nothing else does.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dapple/render.hpp"
#include "dapple/scene.hpp"

namespace dapple {
namespace {

RenderOptions small_picture(float target_rmse) {
  RenderOptions options;
  options.width = options.height = 32;
  options.spp = 64;
  options.target_rmse = target_rmse;
  return options;
}

// With a target it is not known in advance how many samples there will be.
TEST(RenderProgress, EndsWithOneWithAndWithoutATarget) {
  for (const float target : {0.0f, 0.001f, 0.02f, 0.2f}) {
    SCOPED_TRACE(target);
    std::vector<double> shown;
    RenderControl control;
    control.progress = [&](double fraction) { shown.push_back(fraction); };
    render(make_procedural("scene:tree?leaves=200"), small_picture(target), control);
    ASSERT_GT(shown.size(), 1u);
    EXPECT_EQ(shown.back(), 1);
    EXPECT_EQ(std::count(shown.begin(), shown.end(), 1.0), 1);
    EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  }
}

TEST(RenderProgress, DoesNotShowOneIfItIsStopped) {
  std::vector<double> shown;
  RenderControl control;
  control.progress = [&](double fraction) { shown.push_back(fraction); };
  control.stop = [asked = 0]() mutable { return ++asked > 1; };
  RenderOptions options = small_picture(0);
  options.width = options.height = 512;  // more than one slice
  ASSERT_TRUE(render(make_procedural("scene:tree?leaves=200"), options, control).interrupted);
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(std::count(shown.begin(), shown.end(), 1.0), 0);
}

// A render that is to stop saves once, at its end, and not before that for a checkpoint that is
// due.
TEST(RenderProgress, AsksWhetherToStopBeforeEachCheckpoint) {
  RenderOptions options = small_picture(0);
  options.width = options.height = 256;
  int asked = 0;
  RenderControl control;
  control.stop = [&] { return ++asked < 0; };
  render(make_procedural("scene:tree?leaves=200"), options, control);
  const int without = asked;
  ASSERT_GT(without, 3) << "one for each slice";
  asked = 0;
  const std::string path = testing::TempDir() + "asks_before_each.ckpt";
  control.checkpoint = path;
  control.checkpoint_every = 0;
  render(make_procedural("scene:tree?leaves=200"), options, control);
  EXPECT_GE(asked, 2 * without - 1);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace dapple
