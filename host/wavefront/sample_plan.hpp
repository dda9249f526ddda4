// Which pixels are sampled next, and how often: all alike, or where the error is.
#pragma once

#include <vector>

#include "dapple/options.hpp"
#include "dapple/shared/pass_params.h"
#include "wavefront/sample_allocation.hpp"

namespace dapple {

/// Pixels that get the same number of samples.
struct WorkGroup {
  std::uint32_t samples = 0;
  std::vector<PixelWork> work;  ///< tile by tile: neighbours in the list are so in the picture
};

/// What is decided depends on the pixels' values alone, never on slices or threads.
class SamplePlan {
 public:
  SamplePlan(int width, int height, const RenderOptions& options);

  [[nodiscard]] bool is_adaptive() const { return target_error_ > 0 || target_rmse_ > 0; }
  /// Every pixel's first samples: all of them, or with a target the least.
  WorkGroup first();
  /// With a target: what is missing for it, in eights but for the most. `variances`: of a batch's
  /// mean, by pass and pixel, batch_variances(). No pixel gets more than 8, or three times what it
  /// has, so that the next decision rests on more; empty when all are done. A pixel may be in
  /// several groups, to be traced in their order.
  std::vector<WorkGroup> next(const std::vector<std::vector<float>>& variances);

  /// Samples of each pixel once all work given out is done.
  [[nodiscard]] const std::vector<std::uint32_t>& samples() const { return samples_; }
  /// Estimated share of the work that is done, [0,1].
  [[nodiscard]] double fraction_done() const { return fraction_done_; }

 private:
  /// Batches that every pixel should have in all.
  [[nodiscard]] BatchCounts wanted(const std::vector<std::vector<float>>& variances) const;

  std::vector<std::uint32_t> order_;  ///< pixels, tile by tile
  std::vector<std::uint32_t> samples_;
  std::uint32_t least_, most_;
  float target_error_, target_rmse_;
  double fraction_done_ = 0;
};

}  // namespace dapple
