#include "wavefront/sample_cost.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>

#include "dapple/shared/ray.h"
#include "wavefront/pixel_neighbourhood.hpp"

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
  std::vector<float> spent(samples.size()), counts(samples.size());
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, spent.size(), static_cast<std::size_t>(width)), [&](const Range& r) {
    for (std::size_t p = r.begin(); p < r.end(); ++p) {
      double sum = nanoseconds(camera, kCameraPrice, p);
      for (const PassWork& work : others) sum += nanoseconds(work, kRayPrice, p);
      spent[p] = static_cast<float>(sum);
      counts[p] = static_cast<float>(samples[p]);
    }
  });
  std::vector<float> costs = neighbourhood_sums(spent, width);
  counts = neighbourhood_sums(counts, width);
  std::transform(costs.begin(), costs.end(), counts.begin(), costs.begin(), std::divides<>());
  return costs;
}

}  // namespace dapple
