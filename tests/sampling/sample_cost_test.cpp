// What samples cost, by pixel: more where rays do more, a mean over neighbours.
#include "sampling/sample_cost.hpp"

#include <gtest/gtest.h>

namespace dapple {
namespace {

PassWork work(std::size_t pixels, float rays, float visits, float tests) {
  return {std::vector<float>(pixels, rays), std::vector<float>(pixels, visits),
          std::vector<float>(pixels, tests)};
}

TEST(SampleCosts, AreASamplesWhateverTheirNumber) {
  const PassWork camera = work(12, 4, 64, 40), ao = work(12, 2, 6, 10);
  const std::vector<float> four = sample_costs(camera, {ao}, std::vector<std::uint32_t>(12, 4), 4);
  const PassWork more_camera = work(12, 16, 256, 160), more_ao = work(12, 8, 24, 40);
  const std::vector<float> sixteen =
      sample_costs(more_camera, {more_ao}, std::vector<std::uint32_t>(12, 16), 4);
  for (std::size_t p = 0; p < 12; ++p) {
    EXPECT_FLOAT_EQ(four[p], four[0]);
    EXPECT_FLOAT_EQ(sixteen[p], four[0]);
  }
}

TEST(SampleCosts, WorkOfOnePixelCountsForItsNeighboursToo) {
  const int width = 5, height = 5;
  PassWork camera = work(25, 2, 0, 0);
  const std::vector<std::uint32_t> samples(25, 2);
  const float bare = sample_costs(camera, {}, samples, width)[0];
  PassWork ao = work(25, 0, 0, 0);
  ao.visits[12] = 90;  // the middle one
  const std::vector<float> costs = sample_costs(camera, {ao}, samples, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool near = x >= 1 && x <= 3 && y >= 1 && y <= 3;
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      if (near) {
        EXPECT_FLOAT_EQ(costs[p], costs[12]);
        EXPECT_GT(costs[p], 2 * bare);
      } else {
        EXPECT_FLOAT_EQ(costs[p], bare);
      }
    }
  }
}

TEST(SampleCosts, SkyIsCheap) {
  const PassWork camera{{8, 8}, {0, 160}, {0, 240}}, ao{{0, 8}, {0, 16}, {0, 80}};
  // Too far apart to be neighbours: a row between them sees nothing either.
  PassWork far_camera = work(12, 8, 0, 0), far_ao = work(12, 0, 0, 0);
  far_camera.visits[11] = camera.visits[1];
  far_camera.tests[11] = camera.tests[1];
  far_ao.rays[11] = ao.rays[1];
  far_ao.visits[11] = ao.visits[1];
  far_ao.tests[11] = ao.tests[1];
  const std::vector<float> costs =
      sample_costs(far_camera, {far_ao}, std::vector<std::uint32_t>(12, 8), 4);
  EXPECT_GT(costs[11], 2 * costs[0]);
}

}  // namespace
}  // namespace dapple
