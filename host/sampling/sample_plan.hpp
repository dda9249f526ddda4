// Which pixels are sampled next, and how often: all alike, or where the error is.
#pragma once

#include <functional>
#include <vector>

#include "dapple/options.hpp"
#include "sampling/round.hpp"
#include "sampling/sample_allocation.hpp"

namespace dapple {

/// In which order samples come that all pixels get alike. Their sums are the same.
enum class SampleOrder {
  pixels,  ///< all of a pixel, then the next
  /// Sixteen of every pixel, then three times what there are, so that the picture is whole early.
  /// Slower than `pixels`: experiment 515.
  passes,
};

/// What is decided depends on the pixels' values, with target_rmse also on what samples cost (which
/// depends on slices and on ray packets), never on threads.
class SamplePlan {
 public:
  using Costs = std::function<std::vector<float>()>;

  /// `samples`: of each pixel, what an earlier plan gave it; empty: none.
  SamplePlan(int width, int height, const RenderOptions& options,
             std::vector<std::uint32_t> samples = {});

  [[nodiscard]] bool is_adaptive() const { return target_error_ > 0 || target_rmse_ > 0; }
  /// With a target and a picture large enough, before it has samples: the least for pilot_pixels(),
  /// where one batch may be enough in a first pilot pass; else empty.
  std::vector<WorkGroup> pilot();
  [[nodiscard]] bool only_pilot_has_samples() const;
  /// Raises the least, to at most four times what it is, to what equal samples would take for an
  /// RMSE, or what three quarters of the pixels that vary want, by the pilot samples, and is
  /// least() then: rounds are few, and packets narrow in the first. Where one batch is enough for
  /// the RMSE, and no more were asked for, other pixels than the pilot's get one. Where so far only
  /// the first pilot pass has samples, and one batch is not by far enough, the remaining pilot
  /// pixels'. `variances` as for next().
  std::vector<WorkGroup> after_pilot(const std::vector<std::vector<float>>& variances);
  /// What pixels lack to the samples that each gets, with a target the least; empty when none do.
  std::vector<WorkGroup> least(SampleOrder order = SampleOrder::pixels);
  /// With a target: what is missing for it, in eights but for the most. `variances`: of a batch's
  /// mean, by pass and pixel, batch_variances(); `costs`: sample_costs(), asked for where an RMSE
  /// is missed. No pixel gets more than eight times what it has, so that the next decision rests on
  /// more, and blocks of 2x2 pixels get the same; empty when all are done. What after_pilot() left
  /// at one batch is brought to two only where by now that is missed: the largest irradiance, which
  /// lights' errors are relative to, is known better. A pixel may be in several groups, to be
  /// traced in their order.
  std::vector<WorkGroup> next(const std::vector<std::vector<float>>& variances, const Costs& costs);

  /// Samples of each pixel once all work given out is done.
  [[nodiscard]] const std::vector<std::uint32_t>& samples() const { return samples_; }
  /// Estimated share of the work that is done once what is given out is, [0,1]; 0 before a
  /// decision.
  [[nodiscard]] double fraction_done() const { return fraction_done_; }

 private:
  /// The least number of samples for those pilot pixels that have none.
  std::vector<WorkGroup> send(const std::vector<bool>& pilot);
  /// Pixels that have samples, in order.
  [[nodiscard]] std::vector<std::uint32_t> sampled() const;
  /// Whether one batch a pixel leaves at most that part of the squared error asked for, by the
  /// variances of those of `pixels` with more.
  [[nodiscard]] bool one_batch_does(const std::vector<std::vector<float>>& variances,
                                    const std::vector<std::uint32_t>& pixels, double part) const;
  /// Samples more that least() gives a pixel.
  [[nodiscard]] std::uint32_t lacks(std::uint32_t has, SampleOrder order) const;
  /// least() where all pixels have the same.
  std::vector<WorkGroup> min_of_all(SampleOrder order);
  /// Batches that the pixels of every block should have in all, where they have so many.
  [[nodiscard]] BatchCounts wanted(const std::vector<std::vector<float>>& variances,
                                   const BatchCounts& have, const Costs& costs) const;
  /// The sum of squared errors of so many pixels at the RMSE asked for.
  [[nodiscard]] double enough_of(std::size_t pixels) const;

  [[nodiscard]] int height() const { return static_cast<int>(samples_.size()) / width_; }

  int width_;
  std::vector<std::uint32_t> order_;  ///< pixels, tile by tile and in these block by block
  std::vector<std::uint32_t> samples_;
  std::uint32_t min_, max_;
  bool one_may_do_;  ///< one batch a pixel, if it is enough
  bool first_pass_;  ///< a quarter of the pilot pixels goes first
  float target_error_, target_rmse_;
  double fraction_done_ = 0;
};

}  // namespace dapple
