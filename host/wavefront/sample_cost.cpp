#include "wavefront/sample_cost.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "dapple/shared/ray.h"

namespace dapple {
namespace {

/// Nanoseconds of two cores, from what renders of 100 thousand to 2 million triangles took whose
/// pixels see mostly sky or mostly leaves.
struct Price {
  double ray, visit, test;
};

/// Nodes are those of a whole beam; a test is one triangle against all its rays.
constexpr Price kCameraPrice{8.0, 25.0 / DAPPLE_BEAM_RAYS, 1.0};
constexpr Price kRayPrice{20.0, 30.0, 4.0};

double nanoseconds(const PassWork& work, const Price& price, std::size_t pixel) {
  return work.rays[pixel] * price.ray + work.visits[pixel] * price.visit +
         work.tests[pixel] * price.test;
}

}  // namespace

std::vector<float> sample_costs(const PassWork& camera, const std::vector<PassWork>& others,
                                const std::vector<std::uint32_t>& samples, int width) {
  std::vector<double> spent(samples.size());
  for (std::size_t p = 0; p < spent.size(); ++p) {
    spent[p] = nanoseconds(camera, kCameraPrice, p);
    for (const PassWork& work : others) spent[p] += nanoseconds(work, kRayPrice, p);
  }
  std::vector<float> costs(samples.size());
  const int height = static_cast<int>(samples.size()) / width;
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0, count = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
          const std::size_t p = static_cast<std::size_t>(v) * width + u;
          sum += spent[p];
          count += samples[p];
        }
      }
      costs[static_cast<std::size_t>(y) * width + x] = static_cast<float>(sum / count);
    }
  });
  return costs;
}

}  // namespace dapple
