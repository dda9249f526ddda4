#include "sampling/sample_plan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "sampling/pilot_samples.hpp"

namespace dapple {
namespace {

/// Side in pixels of the tiles in which work is listed: their 64 camera rays are coherent.
constexpr int kTile = 8;

/// Side in pixels of the blocks that get the same number of samples, so that packets of few samples
/// a pixel stay coherent: experiment 507.
constexpr int kBlock = 2;

/// In a round a pixel gets at most so many times the samples that it has: experiment 508.
constexpr std::uint32_t kMaxMore = 8;

/// A pixel gets more sample batches in multiples of this: experiment 509.
constexpr std::uint32_t kUnit = 2;

/// Part of the target's squared error that allocations aim at, since estimates change as samples
/// come: experiment 510.
constexpr double kAim = 0.95;

/// Part of the squared error asked for that one batch a pixel may leave, by the estimate of the
/// pilot pixels: experiment 511.
constexpr double kAimOfOne = 0.8;

/// The same by the estimate of the first pilot pass: experiment 512.
constexpr double kAimOfFirstPass = 0.25;

/// After the pilot all pixels get at most so many times the minimum, since pixels without a hit
/// need none: experiment 513.
constexpr std::uint32_t kMaxAfterPilot = 4;

/// Up to so many groups get all of their samples at once; more groups are split into powers of two.
constexpr std::size_t kMaxGroups = 4;

/// With SampleOrder::passes: samples of every pixel in the first pass, and the growth in each later
/// one.
constexpr std::uint32_t kFirst = 16, kPassGrowth = 3;

std::uint32_t whole_batches(int samples) {
  return (static_cast<std::uint32_t>(samples) + DAPPLE_SAMPLE_BATCH - 1) / DAPPLE_SAMPLE_BATCH *
         DAPPLE_SAMPLE_BATCH;
}

/// The next power of two, at which the sequence is stratified best: experiment 514.
std::uint32_t well_stratified(double samples) {
  return std::bit_ceil(static_cast<std::uint32_t>(std::ceil(samples)));
}

/// Calls `take` with each pixel of a block.
template <class Take>
void for_block(int left, int top, int width, int height, const Take& take) {
  for (int y = top; y < std::min(top + kBlock, height); ++y)
    for (int x = left; x < std::min(left + kBlock, width); ++x)
      take(static_cast<std::uint32_t>(y * width + x));
}

/// The pixels of the tiles whose rows begin at `top`, into `next`.
void list_tiles(int top, int width, int height, std::uint32_t* next) {
  const int bottom = std::min(top + kTile, height);
  for (int left = 0; left < width; left += kTile)
    for (int y = top; y < bottom; y += kBlock)
      for (int x = left; x < std::min(left + kTile, width); x += kBlock)
        for_block(x, y, width, height, [&](std::uint32_t pixel) { *next++ = pixel; });
}

std::vector<std::uint32_t> tile_order(int width, int height) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(width) * height);
  tbb::parallel_for(0, (height + kTile - 1) / kTile, [&](int row) {
    const int top = row * kTile;
    list_tiles(top, width, height, order.data() + static_cast<std::size_t>(top) * width);
  });
  return order;
}

/// Calls `visit` with each block's number and each of its pixels.
template <class Visit>
void visit_blocks(int width, std::size_t pixels, const Visit& visit) {
  const int height = static_cast<int>(pixels) / width, columns = (width + kBlock - 1) / kBlock;
  tbb::parallel_for(0, (height + kBlock - 1) / kBlock, [&](int row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t block = static_cast<std::size_t>(row) * columns + column;
      for_block(column * kBlock, row * kBlock, width, height,
                [&](std::uint32_t pixel) { visit(block, pixel); });
    }
  });
}

/// Joins the values of each block's pixels; `none` is the value of an empty block.
template <class T, class Join>
std::vector<T> by_block(const std::vector<T>& values, int width, T none, const Join& join) {
  const std::size_t columns = (width + kBlock - 1) / kBlock;
  const std::size_t rows = (values.size() / width + kBlock - 1) / kBlock;
  std::vector<T> joined(columns * rows, none);
  visit_blocks(width, values.size(), [&](std::size_t block, std::uint32_t pixel) {
    joined[block] = join(joined[block], values[pixel]);
  });
  return joined;
}

std::vector<float> block_sums(const std::vector<float>& values, int width) {
  return by_block(values, width, 0.0f, std::plus<>());
}

template <class T>
std::vector<T> block_most(const std::vector<T>& values, int width) {
  return by_block(values, width, T{0}, [](T a, T b) { return std::max(a, b); });
}

/// Of those above 0; 0 if there are none.
float lower_quartile(std::vector<float> values) {
  std::erase(values, 0.0f);
  if (values.empty()) return 0;
  const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quarter, values.end());
  return *quarter;
}

double part_above_0(const std::vector<float>& values) {
  const auto above = std::count_if(values.begin(), values.end(), [](float v) { return v > 0; });
  return static_cast<double>(above) / static_cast<double>(values.size());
}

/// Batches that each block has.
BatchCounts block_batches(const std::vector<std::uint32_t>& samples, int width) {
  BatchCounts counts = block_most(samples, width);
  for (std::uint32_t& count : counts) count /= DAPPLE_SAMPLE_BATCH;
  return counts;
}

/// Number of distinct values other than 0.
std::size_t count_values(const std::vector<std::uint32_t>& values) {
  std::set<std::uint32_t> different;
  std::uint32_t last = 0;
  for (const std::uint32_t value : values) {
    if (value != last && value != 0) different.insert(value);
    last = value;
  }
  return different.size();
}

/// Joins the values of `pixels` block by block; the pixels of a block are consecutive.
template <class Join>
std::vector<float> of_blocks_among(const std::vector<std::uint32_t>& pixels,
                                   const std::vector<float>& values, const Join& join) {
  constexpr std::size_t kPixels = std::size_t{kBlock} * kBlock;
  std::vector<float> joined(pixels.size() / kPixels);
  for (std::size_t block = 0; block < joined.size(); ++block)
    for (std::size_t i = block * kPixels; i < (block + 1) * kPixels; ++i)
      joined[block] = join(joined[block], values[pixels[i]]);
  return joined;
}

/// As std::min_element(), which compilers do not vectorize.
std::uint32_t fewest(const std::vector<std::uint32_t>& values) {
  std::uint32_t least = values.front();
  for (const std::uint32_t value : values) least = std::min(least, value);
  return least;
}

bool all_equal(const std::vector<std::uint32_t>& values) {
  return std::all_of(values.begin(), values.end(), [&](auto v) { return v == values.front(); });
}

std::vector<WorkGroup> in_order(std::map<std::uint32_t, WorkGroup>&& groups) {
  std::vector<WorkGroup> out;
  for (auto& [size, group] : groups) out.push_back(std::move(group));
  return out;
}

}  // namespace

SamplePlan::SamplePlan(int width, int height, const RenderOptions& options,
                       std::vector<std::uint32_t> samples)
    : width_(width),
      order_(tile_order(width, height)),
      samples_(std::move(samples)),
      min_(static_cast<std::uint32_t>(options.spp)),
      max_(min_),
      one_may_do_(options.target_rmse > 0 && min_ <= DAPPLE_SAMPLE_BATCH),
      // Lights' errors are relative to the largest irradiance, of which few pixels know little.
      first_pass_(one_may_do_ && !options.light),
      target_error_(options.target_error),
      target_rmse_(options.target_rmse) {
  samples_.resize(order_.size(), 0);
  if (!is_adaptive()) return;
  // Two batches are the least that tell a variance.
  min_ = std::max(2 * DAPPLE_SAMPLE_BATCH, whole_batches(options.spp));
  max_ = std::max(min_, whole_batches(options.max_spp));
  // What an earlier plan left at one batch is judged again by next().
  if (one_may_do_ && fewest(samples_) == DAPPLE_SAMPLE_BATCH) min_ = DAPPLE_SAMPLE_BATCH;
}

std::vector<WorkGroup> SamplePlan::least(SampleOrder order) {
  if (fewest(samples_) >= min_) return {};
  if (all_equal(samples_)) return min_of_all(order);
  std::map<std::uint32_t, WorkGroup> groups;
  WorkGroup* group = nullptr;  // neighbours mostly lack the same
  for (const std::uint32_t pixel : order_) {
    std::uint32_t& has = samples_[pixel];
    const std::uint32_t more = lacks(has, order);
    if (more == 0) continue;
    if (!group || group->samples != more) {
      group = &groups[more];
      group->samples = more;
      group->work.reserve(order_.size());
    }
    group->work.push_back({pixel, has});
    has += more;
  }
  return in_order(std::move(groups));
}

std::uint32_t SamplePlan::lacks(std::uint32_t has, SampleOrder order) const {
  const std::uint32_t more = min_ - std::min(has, min_);
  return order == SampleOrder::passes ? std::min(more, std::max(kPassGrowth * has, kFirst)) : more;
}

std::vector<WorkGroup> SamplePlan::min_of_all(SampleOrder order) {
  const std::uint32_t has = samples_.front(), more = lacks(has, order);
  if (more == 0) return {};
  std::vector<WorkGroup> groups(1);
  WorkGroup& all = groups.front();
  all.samples = more;
  all.work.resize(order_.size());
  tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
    all.work[i] = {order_[i], has};
  });
  std::fill(samples_.begin(), samples_.end(), has + more);
  return groups;
}

// Of blocks. Sums of their pixels' variances and costs stand in the ratio of the means, and their
// errors add up to those of the picture.
BatchCounts SamplePlan::wanted(const std::vector<std::vector<float>>& variances,
                               const BatchCounts& have, const Costs& costs) const {
  BatchCounts wanted = have;
  const AllocationLimits limits{kUnit, max_ / DAPPLE_SAMPLE_BATCH};
  if (target_rmse_ > 0) {
    const double enough = enough_of(samples_.size());
    std::vector<float> block_costs;
    for (const std::vector<float>& pass : variances) {
      const std::vector<float> of_blocks = block_sums(pass, width_);
      if (squared_errors(of_blocks, have) <= enough) continue;
      if (block_costs.empty()) block_costs = block_sums(costs(), width_);
      want_rmse(of_blocks, block_costs, kAim * enough, have, limits, wanted);
    }
  } else {
    for (const std::vector<float>& pass : variances)
      want_error(block_most(pass, width_), target_error_, have, limits, wanted);
  }
  return wanted;
}

double SamplePlan::enough_of(std::size_t pixels) const {
  return double{target_rmse_} * target_rmse_ * static_cast<double>(pixels);
}

std::vector<WorkGroup> SamplePlan::pilot() {
  if (!is_adaptive() || samples_.front() > 0 || !all_equal(samples_)) return {};
  return send(pilot_pixels(width_, height(), first_pass_ ? PilotPass::first_pass : PilotPass::all));
}

std::vector<WorkGroup> SamplePlan::send(const std::vector<bool>& pilot) {
  if (pilot.empty()) return {};
  std::vector<WorkGroup> groups(1);
  groups.front().samples = min_;
  for (const std::uint32_t pixel : order_) {
    if (!pilot[pixel] || samples_[pixel] > 0) continue;
    groups.front().work.push_back({pixel, 0});
    samples_[pixel] = min_;
  }
  return groups;
}

std::vector<std::uint32_t> SamplePlan::sampled() const {
  std::vector<std::uint32_t> pixels;
  std::copy_if(order_.begin(), order_.end(), std::back_inserter(pixels),
               [&](std::uint32_t pixel) { return samples_[pixel] > 0; });
  return pixels;
}

bool SamplePlan::only_pilot_has_samples() const {
  return is_adaptive() && !all_equal(samples_) &&
         std::find(samples_.begin(), samples_.end(), 0u) != samples_.end();
}

bool SamplePlan::one_batch_does(const std::vector<std::vector<float>>& variances,
                                const std::vector<std::uint32_t>& pixels, double part) const {
  if (!one_may_do_) return false;
  bool any_varies = false;  // who sees nothing knows nothing
  for (const std::vector<float>& pass : variances) {
    double error = 0, enough = 0;
    for (const std::uint32_t pixel : pixels) {
      if (samples_[pixel] <= DAPPLE_SAMPLE_BATCH) continue;
      error += pass[pixel];
      enough += double{target_rmse_} * target_rmse_;
    }
    if (error > part * enough) return false;
    any_varies |= error > 0;
  }
  return any_varies;
}

std::vector<WorkGroup> SamplePlan::after_pilot(const std::vector<std::vector<float>>& variances) {
  const std::vector<std::uint32_t> pilot = sampled();
  const std::vector<bool> all = pilot_pixels(width_, height());
  const bool is_first_pass = pilot.size() < static_cast<std::size_t>(std::ranges::count(all, true));
  if (one_batch_does(variances, pilot, is_first_pass ? kAimOfFirstPass : kAimOfOne)) {
    min_ = DAPPLE_SAMPLE_BATCH;
    fraction_done_ = 1;
    return least();
  }
  if (is_first_pass) return send(all);
  const double enough = enough_of(pilot.size());
  double batches = 0, varied = 0;
  for (const std::vector<float>& pass : variances) {
    const auto most = [](float a, float b) { return std::max(a, b); };
    const std::vector<float> max_of_block = of_blocks_among(pilot, pass, most);
    varied = std::max(varied, part_above_0(max_of_block));
    if (target_rmse_ > 0) {
      const std::vector<float> sums = of_blocks_among(pilot, pass, std::plus<>());
      batches = std::max(batches, squared_errors(sums, BatchCounts(sums.size(), 1)) / enough);
    } else {
      const double enough_of_block = double{target_error_} * target_error_;
      batches = std::max(batches, lower_quartile(max_of_block) / enough_of_block);
    }
  }
  const double samples = std::min<double>(batches * DAPPLE_SAMPLE_BATCH, max_);
  const std::uint32_t given = well_stratified(samples);
  min_ = std::max(min_, std::min({given, kMaxAfterPilot * min_, max_}));
  fraction_done_ = min_ / (min_ + varied * std::max(0.0, samples - min_));
  return least();
}

std::vector<WorkGroup> SamplePlan::next(const std::vector<std::vector<float>>& variances,
                                        const Costs& costs) {
  if (fewest(samples_) < 2 * DAPPLE_SAMPLE_BATCH) {
    fraction_done_ = 1;
    if (one_batch_does(variances, order_, 1.0)) return {};
    min_ = 2 * DAPPLE_SAMPLE_BATCH;
    return least();
  }
  const BatchCounts have = block_batches(samples_, width_);
  const BatchCounts of_blocks = wanted(variances, have, costs);
  if (of_blocks == have) {
    fraction_done_ = 1;
    return {};
  }
  BatchCounts all(samples_.size());
  visit_blocks(width_, all.size(),
               [&](std::size_t block, std::uint32_t pixel) { all[pixel] = of_blocks[block]; });
  std::vector<std::uint32_t> more(all.size());
  double done = 0, missing = 0;
  for (std::size_t pixel = 0; pixel < more.size(); ++pixel) {
    const std::uint32_t has = samples_[pixel] / DAPPLE_SAMPLE_BATCH;
    more[pixel] = std::min(all[pixel] - has, kMaxMore * has / kUnit * kUnit);
    done += has + more[pixel];
    missing += all[pixel] - has - more[pixel];
  }
  std::map<std::uint32_t, WorkGroup> groups;
  const bool whole = count_values(more) <= kMaxGroups;
  for (const std::uint32_t pixel : order_) {
    // In parts of powers of two there are few groups whatever pixels want.
    for (std::uint32_t left = more[pixel], part = 0; left; left -= part) {
      part = whole ? left : left & -left;
      WorkGroup& group = groups[part];
      group.samples = part * DAPPLE_SAMPLE_BATCH;
      group.work.push_back({pixel, samples_[pixel]});
      samples_[pixel] += group.samples;
    }
  }
  fraction_done_ = std::max(fraction_done_, done / (done + missing));
  return in_order(std::move(groups));
}

}  // namespace dapple
