// Checks coarsely that the time of prefiltering is linear in the number of triangles. It measures
// processor time, which other programs hardly disturb. `dapple-bench accuracy --linear` measures
// larger scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>

#include "bvh/build/object_bvh.hpp"

namespace dapple {
namespace {

/// Processor time, in seconds, of prefiltering a cloud of `leaves` leaves of two triangles each,
/// without building its BVH: the minimum of several runs.
double prefilter_seconds(int leaves) {
  const Scene scene = make_procedural("scene:cloud?leaves=" + std::to_string(leaves));
  BuiltObject built = build_object(scene, OpaqueTexels(scene), scene.meshes[0]);
  const TextureIntegrals integrals(scene, built.object.textured);
  double min = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const std::clock_t start = std::clock();
    prefilter(built, integrals);
    min = std::min(min, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return min;
}

// Ten times the triangles should take ten times the time, or a little more where the data exceed
// the caches. A quadratic algorithm would take a hundred times. The limit of 20 leaves room for
// disturbed measurements.
TEST(LinearTime, TenTimesTheTrianglesTakeLessThanTwentyTimesTheTimeToPrefilter) {
  const double few = prefilter_seconds(10'000), many = prefilter_seconds(100'000);
  std::printf("prefiltering 20,000 triangles takes %.3f s, 200,000 %.3f s: %.1f times\n", few, many,
              many / few);
  EXPECT_LT(many / few, 20);
  // A smaller ratio would mean that the clock did not measure the work.
  EXPECT_GT(many / few, 3);
}

}  // namespace
}  // namespace dapple
