// Which pixels are sampled next, and how often: all alike, or where the error is.
#pragma once

#include <vector>

#include "dapple/options.hpp"
#include "dapple/shared/pass_params.h"

namespace dapple {

/// Pixels that get the same number of samples.
struct WorkGroup {
  std::uint32_t samples = 0;
  std::vector<PixelWork> work;  ///< in the order of the pixels
};

/// What is decided depends on the pixels' values alone, never on slices or threads.
class SamplePlan {
 public:
  SamplePlan(std::uint32_t pixels, const RenderOptions& options);

  [[nodiscard]] bool is_adaptive() const { return target_ > 0; }
  /// Every pixel's first samples: all of them, or with a target error the least.
  WorkGroup first();
  /// With a target error: what pixels want whose errors are above it. `variances`: of a batch's
  /// mean, by pass and pixel, batch_variances(). No pixel more than doubles, so that the next
  /// decision rests on more; empty when all are done.
  std::vector<WorkGroup> next(const std::vector<std::vector<float>>& variances);

  /// Samples of each pixel once all work given out is done.
  [[nodiscard]] const std::vector<std::uint32_t>& samples() const { return samples_; }
  /// Estimated share of the work that is done, [0,1].
  [[nodiscard]] double fraction_done() const { return fraction_done_; }

 private:
  std::vector<std::uint32_t> samples_;
  std::uint32_t least_, most_;
  float target_;
  double fraction_done_ = 0;
};

}  // namespace dapple
