#include "wavefront/pixel_error.hpp"

#include <algorithm>

#include "dapple/shared/pass_params.h"
#include "wavefront/pixel_neighbourhood.hpp"

namespace dapple {
namespace {

/// Batches that the neighbourhood counts for. Small weights make samples depend on the pixel's own
/// values, which biases it, and lose pixels whose first samples missed an edge: at 4 biases of
/// whole pictures were twice as large as at 16, and a third more pixels off by more than four
/// times their error. Larger ones take more samples.
constexpr float kNeighbourhoodWeight = 16.0f;

}  // namespace

std::vector<float> batch_variances(const BatchMoments& moments,
                                   const std::vector<std::uint32_t>& samples, int width) {
  const auto freedom = [&](std::size_t p) {
    const std::uint32_t whole = samples[p] / DAPPLE_BATCH;
    return static_cast<float>(whole) - 1.0f;
  };
  const auto own = [&](std::size_t p) -> std::array<float, 2> {
    if (samples[p] == 0) return {};
    const float square = (freedom(p) + 1.0f) * moments.mean[p] * moments.mean[p];
    return {std::max(0.0f, (moments.squares[p] - square) / freedom(p)), 1.0f};
  };
  std::vector<float> variances(samples.size());
  visit_neighbourhoods(
      samples.size(), width, own,
      [&](std::size_t p, const std::array<float, 2>& of_pixel, const std::array<float, 2>& sums) {
        if (samples[p] == 0) return;
        const float around = sums[0] / sums[1] * kNeighbourhoodWeight;
        variances[p] = (of_pixel[0] * freedom(p) + around) / (freedom(p) + kNeighbourhoodWeight);
      });
  return variances;
}

}  // namespace dapple
