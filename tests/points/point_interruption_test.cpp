// measure_points() ends soon after its stop function returns true: also within one set of rays,
// which takes minutes if there are many points.
#include <gtest/gtest.h>

#include "dapple/points.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

struct Stopped {
  bool interrupted;
  int calls;  ///< of the stop function
  std::size_t columns;
};

/// Stops at the `last` call, counted from 1.
Stopped stopped_at(const PointOptions& options, int last) {
  scene_test::Points random(1);
  std::vector<V3f> points, normals(2000, V3f(0, 1, 0));
  for (std::size_t i = 0; i < normals.size(); ++i) points.push_back(random.in_cube(2));
  Stopped stopped{};
  RenderControl control;
  control.stop = [&] { return ++stopped.calls >= last; };
  const PointResult result =
      measure_points(make_procedural("scene:tree?leaves=500"), points, normals, options, control);
  stopped.interrupted = result.interrupted;
  stopped.columns = result.columns.size();
  return stopped;
}

PointOptions many_rays() {
  PointOptions options;
  options.rays = 1 << 14;
  return options;
}

TEST(PointInterruption, AnUnfinishedSetIsLeft) {
  PointOptions options = many_rays();
  // Stopped between the slices of the first set, it does not ask again.
  const Stopped first = stopped_at(options, 2);
  EXPECT_TRUE(first.interrupted);
  EXPECT_EQ(first.calls, 2);
  // There are more slices than sets of AO and sky view factor, so the stop fell into a set.
  const Stopped never = stopped_at(options, 1 << 30);
  EXPECT_FALSE(never.interrupted);
  EXPECT_GT(never.calls, 2 * 16);
}

TEST(PointInterruption, SoAreExactValuesForTheCorrectionOfTheBias) {
  PointOptions options;
  options.rays = 1 << 12;
  options.max_bias = 0;  // no footprint is chosen
  options.sky_view_factor = false;
  const Stopped never = stopped_at(options, 1 << 30);
  EXPECT_FALSE(never.interrupted);
  EXPECT_EQ(never.columns, 2u) << "ao, ao_error";
  // They are found last.
  const Stopped last = stopped_at(options, never.calls);
  EXPECT_TRUE(last.interrupted);
  EXPECT_EQ(last.calls, never.calls);
  EXPECT_EQ(last.columns, 0u);
}

}  // namespace
}  // namespace dapple
