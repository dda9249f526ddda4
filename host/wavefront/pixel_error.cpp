#include "wavefront/pixel_error.hpp"

#include <tbb/parallel_for.h>

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
  const int height = static_cast<int>(samples.size()) / width;
  std::vector<float> own(samples.size()), known(samples.size());
  tbb::parallel_for(0, height, [&](int y) {
    const std::size_t end = static_cast<std::size_t>(y + 1) * width;
    for (std::size_t p = end - width; p < end; ++p) {
      if (samples[p] == 0) continue;
      const float square = (freedom(p) + 1.0f) * moments.mean[p] * moments.mean[p];
      own[p] = std::max(0.0f, (moments.squares[p] - square) / freedom(p));
      known[p] = 1.0f;
    }
  });
  std::vector<float> variances = neighbourhood_sums(own, width);
  const std::vector<float> counts = neighbourhood_sums(known, width);
  tbb::parallel_for(0, height, [&](int y) {
    const std::size_t end = static_cast<std::size_t>(y + 1) * width;
    for (std::size_t p = end - width; p < end; ++p) {
      if (samples[p] == 0) {
        variances[p] = 0;
        continue;
      }
      const float around = variances[p] / counts[p] * kNeighbourhoodWeight;
      variances[p] = (own[p] * freedom(p) + around) / (freedom(p) + kNeighbourhoodWeight);
    }
  });
  return variances;
}

}  // namespace dapple
