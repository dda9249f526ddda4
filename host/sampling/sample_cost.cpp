#include "sampling/sample_cost.hpp"

#include <array>

#include "dapple/shared/ray.h"
#include "sampling/pixel_neighbourhood.hpp"

namespace dapple {
namespace {

/// Nanoseconds of two cores: experiment 506.
struct Price {
  double ray, visit, test;
};

/// Nodes and tests are those of all rays of an item.
constexpr Price kCameraPrice{8.0, 50.0 / DAPPLE_ITEM_RAYS, 4.0 / DAPPLE_ITEM_RAYS};
constexpr Price kRayPrice{20.0, 30.0, 4.0};

double nanoseconds(const PassWork& work, const Price& price, std::size_t pixel) {
  return work.rays[pixel] * price.ray + work.visits[pixel] * price.visit +
         work.tests[pixel] * price.test;
}

}  // namespace

std::vector<float> sample_costs(const PassWork& camera, const std::vector<PassWork>& others,
                                const std::vector<std::uint32_t>& samples, int width) {
  const auto spent = [&](std::size_t p) -> std::array<float, 2> {
    double sum = nanoseconds(camera, kCameraPrice, p);
    for (const PassWork& work : others) sum += nanoseconds(work, kRayPrice, p);
    return {static_cast<float>(sum), static_cast<float>(samples[p])};
  };
  std::vector<float> costs(samples.size());
  visit_neighbourhoods(samples.size(), width, spent,
                       [&](std::size_t p, const auto&, const std::array<float, 2>& sums) {
                         costs[p] = sums[0] / sums[1];
                       });
  return costs;
}

}  // namespace dapple
