#include "sampling/sample_plan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "sampling/pilot_samples.hpp"
#include "sampling/tile_order.hpp"

namespace dapple {
namespace {

/// In a round a pixel gets at most so many times the samples that it has: experiment 508.
constexpr std::uint32_t kMaxMore = 8;

/// A pixel gets more sample batches in multiples of this: experiment 509.
constexpr std::uint32_t kUnit = 2;

/// After the pilot all pixels get at most so many times the minimum: the errors of pixels with more
/// samples are known better, and pixels without a hit need none. Experiment 513.
constexpr std::uint32_t kMaxAfterPilot = 4;

/// After the pilot pixels get a power of two that may be smaller than what they need, but not so
/// many times: later rounds double the samples of some pixels only. Experiment 547.
constexpr double kMaxMissing = 1.7;

/// Pixels that lack equal numbers of samples are a group, unless there are more numbers than this:
/// checkpoints have a section for each group, and small groups are slow.
constexpr std::size_t kMaxNumbers = 64;

/// With SampleOrder::sweeps: samples of every pixel in the first sweep, and the growth in each
/// later one.
constexpr std::uint32_t kFirstSweep = 16, kSweepGrowth = 3;

std::uint32_t whole_batches(int samples) {
  return (static_cast<std::uint32_t>(samples) + DAPPLE_SAMPLE_BATCH - 1) / DAPPLE_SAMPLE_BATCH *
         DAPPLE_SAMPLE_BATCH;
}

std::uint32_t whole_units(std::uint32_t batches) { return (batches + kUnit - 1) / kUnit * kUnit; }

/// The next power of two, at which the sequence is stratified best: experiment 514.
std::uint32_t well_stratified(double samples) {
  return std::bit_ceil(static_cast<std::uint32_t>(std::ceil(samples)));
}

double fraction_above_0(const std::vector<float>& values) {
  const auto above = std::count_if(values.begin(), values.end(), [](float v) { return v > 0; });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

/// The values of those pixels that have samples, in the order of tracing.
std::vector<float> of_sampled(const std::vector<std::uint32_t>& order,
                              const std::vector<std::uint32_t>& samples,
                              const std::vector<float>& values) {
  std::vector<float> out;
  for (const std::uint32_t pixel : order)
    if (samples[pixel] > 0) out.push_back(values[pixel]);
  return out;
}

BatchCounts batches_of(const std::vector<std::uint32_t>& samples) {
  BatchCounts batches(samples.size());
  std::transform(samples.begin(), samples.end(), batches.begin(),
                 [](std::uint32_t count) { return count / DAPPLE_SAMPLE_BATCH; });
  return batches;
}

double sum_of(const std::vector<float>& variances) {
  return squared_errors(variances, BatchCounts(variances.size(), 1));
}

/// As std::min_element(), which compilers do not vectorize.
std::uint32_t min_of(const std::vector<std::uint32_t>& values) {
  std::uint32_t min = values.front();
  for (const std::uint32_t value : values) min = std::min(min, value);
  return min;
}

bool all_equal(const std::vector<std::uint32_t>& values) {
  return std::all_of(values.begin(), values.end(), [&](auto v) { return v == values.front(); });
}

/// Groups of pixels by the number of samples that they get.
using Groups = std::map<std::uint32_t, SampleGroup>;

void add_to_group(Groups& groups, std::uint32_t pixel, std::uint32_t more, std::uint32_t& has,
                  std::uint32_t first = 0) {
  SampleGroup& group = groups[more];
  group.samples = more;
  group.work.push_back({pixel, first + has});
  has += more;
}

std::vector<SampleGroup> in_order(Groups&& groups) {
  std::vector<SampleGroup> out;
  for (auto& [size, group] : groups) out.push_back(std::move(group));
  return out;
}

}  // namespace

std::uint32_t least_samples(int spp) {
  return std::max(2 * DAPPLE_SAMPLE_BATCH, whole_batches(spp));  // one has no variance
}

SamplePlan::SamplePlan(int width, int height, const RenderOptions& options,
                       std::vector<std::uint32_t> samples, std::uint32_t first)
    : width_(width),
      order_(tile_order(width, height)),
      samples_(std::move(samples)),
      first_(first),
      min_(static_cast<std::uint32_t>(options.spp) -
           std::min(first, static_cast<std::uint32_t>(options.spp))),
      max_(min_),
      target_{options.target_error, options.target_rmse} {
  samples_.resize(order_.size(), 0);
  if (!is_adaptive()) return;
  min_ = least_samples(options.spp);
  max_ = std::max(min_, static_cast<std::uint32_t>(options.max_spp) / DAPPLE_SAMPLE_BATCH *
                            DAPPLE_SAMPLE_BATCH);
}

std::vector<SampleGroup> SamplePlan::pilot() {
  if (target_.rmse <= 0 || samples_.front() > 0 || !all_equal(samples_)) return {};
  const std::vector<bool> pilot = pilot_pixels(width_, height());
  if (pilot.empty()) return {};
  Groups groups;
  for (const std::uint32_t pixel : order_)
    if (pilot[pixel]) add_to_group(groups, pixel, min_, samples_[pixel]);
  return in_order(std::move(groups));
}

bool SamplePlan::only_pilot_has_samples() const {
  return is_adaptive() && min_of(samples_) == 0 && !all_equal(samples_);
}

std::vector<SampleGroup> SamplePlan::after_pilot(const PassVariances& variances) {
  double batches = 0, varied = 0;
  for (const std::vector<float>& pass : variances) {
    const std::vector<float> pilot = of_sampled(order_, samples_, pass);
    varied = std::max(varied, fraction_above_0(pilot));
    batches = std::max(batches, sum_of(pilot) / squared_target(target_.rmse, pilot.size()));
  }
  const double samples = std::min<double>(batches * DAPPLE_SAMPLE_BATCH, max_);
  min_ = std::max(min_,
                  std::min({well_stratified(samples / kMaxMissing), kMaxAfterPilot * min_, max_}));
  fraction_done_ = min_ / (min_ + varied * std::max(0.0, samples - min_));
  return least();
}

std::vector<SampleGroup> SamplePlan::least(SampleOrder order) {
  if (min_of(samples_) >= min_) return {};
  if (all_equal(samples_)) return least_of_all(order);
  std::set<std::uint32_t> numbers;
  for (const std::uint32_t has : samples_) numbers.insert(lacks(has, order));
  const bool splits = numbers.size() > kMaxNumbers;
  Groups groups;
  for (const std::uint32_t pixel : order_) {
    std::uint32_t& has = samples_[pixel];
    std::uint32_t left = lacks(has, order);
    while (left > 0) {  // split into powers of two, as in next()
      const std::uint32_t more = splits ? left & -left : left;
      add_to_group(groups, pixel, more, has, first_);
      left -= more;
    }
  }
  return in_order(std::move(groups));
}

std::uint32_t SamplePlan::lacks(std::uint32_t has, SampleOrder order) const {
  const std::uint32_t more = min_ - std::min(has, min_);
  return order == SampleOrder::sweeps ? std::min(more, std::max(kSweepGrowth * has, kFirstSweep))
                                      : more;
}

std::vector<SampleGroup> SamplePlan::least_of_all(SampleOrder order) {
  const std::uint32_t has = samples_.front(), more = lacks(has, order);
  if (more == 0) return {};
  std::vector<SampleGroup> groups(1);
  SampleGroup& all = groups.front();
  all.samples = more;
  all.work.resize(order_.size());
  tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
    all.work[i] = {order_[i], first_ + has};
  });
  std::fill(samples_.begin(), samples_.end(), has + more);
  return groups;
}

std::vector<SampleGroup> SamplePlan::next(const PassVariances& variances) {
  const BatchCounts have = batches_of(samples_);
  const std::uint32_t max = max_ / DAPPLE_SAMPLE_BATCH;
  const BatchCounts of_blocks = allocate_batches(variances, have, width_, target_, max);
  if (of_blocks == block_maxima(have, width_)) {
    fraction_done_ = 1;
    return {};
  }
  BatchCounts all(samples_.size());
  visit_blocks(width_, all.size(),
               [&](std::size_t block, std::uint32_t pixel) { all[pixel] = of_blocks[block]; });
  double done = 0, missing = 0;
  Groups groups;
  for (const std::uint32_t pixel : order_) {
    const std::uint32_t has = have[pixel];
    const std::uint32_t missing_here = std::min(whole_units(all[pixel] - has), max - has);
    const std::uint32_t more = std::min(missing_here, kMaxMore * has);
    done += has + more;
    missing += missing_here - more;
    // Split into powers of two, so that there are few groups, and large ones.
    for (std::uint32_t left = more; left; left &= left - 1)
      add_to_group(groups, pixel, (left & -left) * DAPPLE_SAMPLE_BATCH, samples_[pixel]);
  }
  fraction_done_ = std::max(fraction_done_, done / (done + missing));
  return in_order(std::move(groups));
}

}  // namespace dapple
