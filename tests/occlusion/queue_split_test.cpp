// Queues are divided into tickets of work. At every length of the queue, every ray is traced and
// finds the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/queued_rays.hpp"

namespace dapple {
namespace {

using namespace scene_test;

/// Transmittances of the rays; each `rays_per_point` consecutive rays start at one point. NaN where
/// a ray was not traced.
std::vector<float> transmittances(const SceneOnDevice& scene, const std::vector<Ray>& rays,
                                  std::size_t rays_per_point, RayOrder order) {
  std::vector<float> values;
  for (const Occlusion& one :
       trace_queue(scene, rays, Estimator::prefiltered, rays_per_point, order))
    values.push_back(one.transmittance);
  return values;
}

std::vector<Ray> first_of(const std::vector<Ray>& rays, std::size_t count) {
  return {rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(count)};
}

class QueueSplit : public testing::Test {
 protected:
  const SceneOnDevice scene_{make_procedural("scene:tree?leaves=2000&opacity=0.5")};
  const std::vector<Ray> rays_ =
      rays_through(scene_.bvh.bounds, 9000, scene_.bvh.bounds.size().length(), 0.01f, 7);
};

TEST_F(QueueSplit, EveryRayOfPixelPacketsIsTraced) {
  const std::vector<float> all = transmittances(scene_, rays_, 1, RayOrder::by_pixel);
  for (const std::size_t count : {1, 63, 255, 256, 257, 1023, 1025, 2047, 2048, 2049, 4096, 8191}) {
    const auto found = transmittances(scene_, first_of(rays_, count), 1, RayOrder::by_pixel);
    EXPECT_TRUE(std::equal(found.begin(), found.end(), all.begin())) << count;
  }
}

// A point with more than 512 rays is divided into several batches; points with few rays share a
// ticket.
TEST_F(QueueSplit, EveryRayOfPointPacketsIsTraced) {
  constexpr std::size_t kPoints = 7;
  for (const std::size_t each : {16, 33, 96, 255, 257, 512, 513, 600, 1100}) {
    std::vector<Ray> rays = first_of(rays_, kPoints * each);
    for (std::size_t i = 0; i < rays.size(); ++i)
      std::copy_n(rays_[i / each].origin, 3, rays[i].origin);
    const auto found = transmittances(scene_, rays, each, RayOrder::any);
    std::vector<float> one_by_one;
    for (std::size_t point = 0; point < kPoints; ++point) {
      const auto begin = rays.begin() + static_cast<std::ptrdiff_t>(point * each);
      const auto of_point = transmittances(
          scene_, {begin, begin + static_cast<std::ptrdiff_t>(each)}, each, RayOrder::any);
      one_by_one.insert(one_by_one.end(), of_point.begin(), of_point.end());
    }
    EXPECT_EQ(found, one_by_one) << each << " rays a point";
  }
}

}  // namespace
}  // namespace dapple
