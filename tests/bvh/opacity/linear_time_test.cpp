// Prefiltering takes time linear in the triangles: a coarse guard, by the processor's time, which
// what else the machine does hardly disturbs. dapple-bench accuracy --linear goes to millions.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>

#include "bvh/build/object_bvh.hpp"

namespace dapple {
namespace {

/// Processor seconds of prefiltering a cloud of leaves, two triangles each, alone: the least of
/// several.
double prefilter_seconds(int leaves) {
  const Scene scene = make_procedural("scene:cloud?leaves=" + std::to_string(leaves));
  BuiltObject built = build_object(scene, scene.meshes[0]);
  const TextureIntegrals integrals(scene, built.object.textured);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    prefilter(built, integrals);
    least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return least;
}

// Ten times the triangles take ten times the time, 11 or 12 where they leave the caches. Anything
// quadratic would take a hundred times; 20 leaves room for a disturbed measurement.
TEST(LinearTime, TenTimesTheTrianglesTakeLessThanTwentyTimesTheTimeToPrefilter) {
  const double few = prefilter_seconds(10'000), many = prefilter_seconds(100'000);
  std::printf("prefiltering 20,000 triangles takes %.3f s, 200,000 %.3f s: %.1f times\n", few, many,
              many / few);
  EXPECT_LT(many / few, 20);
  // Otherwise the clock has measured nothing.
  EXPECT_GT(many / few, 3);
}

}  // namespace
}  // namespace dapple
