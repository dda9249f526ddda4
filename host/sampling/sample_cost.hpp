// What a pixel's samples cost: some see only sky, others go through leaves and send rays through
// more of them.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple {

/// What the rays of one kind did for each pixel, sums over its samples.
struct PassWork {
  std::vector<float> rays, visits, tests;
};

/// Nanoseconds of a sample, by pixel, a mean over each pixel's neighbourhood (one sample's cost
/// says little of the next one's). Only their ratios count. `camera`: visits and tests as
/// SampleHits has them; `others`: of AO and lights.
std::vector<float> sample_costs(const PassWork& camera, const std::vector<PassWork>& others,
                                const std::vector<std::uint32_t>& samples, int width);

}  // namespace dapple
