// Sums over the rays of points on the device (kernels/occlusion/ray_sums.cl), against the host's.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "passes/occlusion_pass.hpp"
#include "passes/queues.hpp"
#include "support/scenes/scene_on_device.hpp"

namespace dapple {
namespace {

constexpr std::size_t kPoints = 5;

/// Rays of random directions and weights, and what they found.
struct Found {
  explicit Found(std::size_t count) : rays(count), occlusions(count) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(-1, 1);
    for (std::size_t i = 0; i < count; ++i) {
      for (float& d : rays[i].direction) d = number(random);
      rays[i].weight = std::max(0.0f, number(random));  // half of them count for nothing
      occlusions[i].transmittance = std::fabs(number(random));
    }
  }
  std::vector<Ray> rays;
  std::vector<Occlusion> occlusions;
};

std::vector<RaySums> sums_of(const Found& found, std::size_t rays_per_point) {
  DeviceContext& context = scene_test::device().context();
  const Queues queues = make_queues(context, kPoints, rays_per_point);
  context.write(queues.rays, found.rays.data(), found.rays.size() * sizeof(Ray));
  context.write(queues.occlusions, found.occlusions.data(),
                found.occlusions.size() * sizeof(Occlusion));
  std::vector<RaySums> sums(kPoints * sums_per_point(rays_per_point));
  const Buffer buffer = context.allocate(sums.size() * sizeof(RaySums));
  sum_rays_pass(context, queues, buffer, kPoints, rays_per_point);
  context.read(buffer, sums.data(), sums.size() * sizeof(RaySums));
  return sums;
}

TEST(RaySums, AreThoseOfTheHostHoweverManyRaysAPointHas) {
  for (const std::size_t rays : {1, 8, 63, 64, 65, 300}) {
    SCOPED_TRACE(rays);
    const Found found(kPoints * rays);
    const std::vector<RaySums> sums = sums_of(found, rays);
    const std::size_t per_point = sums_per_point(rays);
    EXPECT_EQ(per_point, (rays + 63) / 64);
    for (std::size_t point = 0; point < kPoints; ++point) {
      double weight = 0, seen = 0, up = 0;
      for (std::size_t r = point * rays; r < (point + 1) * rays; ++r) {
        const Ray& ray = found.rays[r];
        const double value = double{ray.weight} * double{found.occlusions[r].transmittance};
        weight += double{ray.weight};
        seen += value;
        up += value * double{ray.direction[1]};
      }
      for (std::size_t k = point * per_point; k < (point + 1) * per_point; ++k) {
        weight -= double{sums[k].weight};
        seen -= double{sums[k].seen};
        up -= double{sums[k].direction[1]};
      }
      const double rounding = 1e-6 * static_cast<double>(rays);
      EXPECT_NEAR(weight, 0, rounding);
      EXPECT_NEAR(seen, 0, rounding);
      EXPECT_NEAR(up, 0, rounding);
    }
  }
}

TEST(RaySums, RaysWithoutWeightCountForNothingWhateverTheyFound) {
  Found found(kPoints);
  for (Ray& ray : found.rays) ray.weight = 0;
  for (Occlusion& occlusion : found.occlusions)
    occlusion.transmittance = std::numeric_limits<float>::quiet_NaN();
  for (const RaySums& sum : sums_of(found, 1)) {
    EXPECT_EQ(sum.weight, 0);
    EXPECT_EQ(sum.seen, 0);
    for (const float component : sum.direction) EXPECT_EQ(component, 0);
  }
}

}  // namespace
}  // namespace dapple
