#include "wavefront/pixel_error.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "dapple/shared/pass_params.h"

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
  std::vector<float> own(samples.size());
  const auto batches = [&](std::size_t p) {
    const std::uint32_t whole = samples[p] / DAPPLE_BATCH;
    return static_cast<float>(whole);
  };
  for (std::size_t p = 0; p < own.size(); ++p) {
    const float square = batches(p) * moments.mean[p] * moments.mean[p];
    own[p] = std::max(0.0f, (moments.squares[p] - square) / (batches(p) - 1.0f));
  }
  std::vector<float> variances(own.size());
  const int height = static_cast<int>(own.size()) / width;
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      int count = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u, ++count)
          sum += own[static_cast<std::size_t>(v) * width + u];
      }
      const std::size_t p = static_cast<std::size_t>(y) * width + x;
      const float freedom = batches(p) - 1.0f;
      variances[p] = (own[p] * freedom + sum / static_cast<float>(count) * kNeighbourhoodWeight) /
                     (freedom + kNeighbourhoodWeight);
    }
  });
  return variances;
}

}  // namespace dapple
