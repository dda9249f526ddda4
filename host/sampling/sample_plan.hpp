// Divides sampling into rounds. In: the samples that pixels have, and their variances. Out: groups
// of pixels with the number of samples to trace. Without a target all pixels get the same number.
// With a target, rounds add what sample_allocation.hpp says is missing. Before a target RMSE, pilot
// pixels are sampled; they tell what every pixel needs (Kirk and Arvo, "Unbiased Sampling
// Techniques for Image Synthesis", 1991).
#pragma once

#include <vector>

#include "dapple/options.hpp"
#include "sampling/round.hpp"
#include "sampling/sample_allocation.hpp"

namespace dapple {

/// The order of samples when all pixels get the same number. The sums are the same.
enum class SampleOrder {
  pixels,  ///< all samples of a pixel, then those of the next
  /// Sixteen samples of every pixel, then three times what there are, so that the picture is whole
  /// early. Slower than `pixels`: experiment 515.
  sweeps,
};

/// Samples that each pixel has with a target, if `spp` are asked for: whole batches, two at least.
std::uint32_t least_samples(int spp);

/// Decisions depend on the pixels' values, not on threads.
class SamplePlan {
 public:
  /// `samples`: what an earlier plan gave each pixel; empty: none. `first`: the number of each
  /// pixel's first sample, above 0 only without a target; `options.spp` counts from sample 0 on.
  SamplePlan(int width, int height, const RenderOptions& options,
             std::vector<std::uint32_t> samples = {}, std::uint32_t first = 0);

  [[nodiscard]] bool is_adaptive() const { return target_.error > 0 || target_.rmse > 0; }

  /// The minimum for pilot_pixels(). Empty without a target RMSE, for small pictures, and once
  /// pixels have samples.
  std::vector<SampleGroup> pilot();
  /// The minimum of samples that each pixel gets; without a target it gets no more.
  [[nodiscard]] std::uint32_t minimum() const { return min_; }
  [[nodiscard]] bool only_pilot_has_samples() const;
  /// Raises the minimum, up to four times, to the number of samples with which all pilot pixels
  /// together have the target RMSE, rounded to a power of two: down if that is enough for most
  /// pixels. Returns least().
  std::vector<SampleGroup> after_pilot(const PassVariances& variances);

  /// What pixels lack to the minimum, or without a target to the number that each gets; empty if
  /// none does.
  std::vector<SampleGroup> least(SampleOrder order = SampleOrder::pixels);

  /// With a target: the samples that are missing for it; empty if none are. No pixel gets more than
  /// eight times what it has, so that the next decision is based on more samples; pixels of a block
  /// get the same. A pixel may be in several groups, which are traced in their order.
  std::vector<SampleGroup> next(const PassVariances& variances);

  /// Samples of each pixel once all groups that were returned are traced.
  [[nodiscard]] const std::vector<std::uint32_t>& samples() const { return samples_; }
  /// Estimated fraction of the work that is done once these groups are traced, [0,1]; 0 before the
  /// first decision.
  [[nodiscard]] double fraction_done() const { return fraction_done_; }

 private:
  /// Samples that least() adds to a pixel.
  [[nodiscard]] std::uint32_t lacks(std::uint32_t has, SampleOrder order) const;
  /// least() if all pixels have the same number of samples.
  std::vector<SampleGroup> least_of_all(SampleOrder order);
  [[nodiscard]] int height() const { return static_cast<int>(samples_.size()) / width_; }

  int width_;
  std::vector<std::uint32_t> order_;  ///< pixels in the order of tracing
  std::vector<std::uint32_t> samples_;
  std::uint32_t first_;
  std::uint32_t min_, max_;
  ErrorTarget target_;
  double fraction_done_ = 0;
};

}  // namespace dapple
