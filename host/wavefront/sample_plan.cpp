#include "wavefront/sample_plan.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

namespace dapple {
namespace {

/// Side of the tiles in which work is listed: 64 neighbours see much the same of the scene.
constexpr int kTile = 8;

/// Side of the blocks of pixels that are given the same samples, so that beams of few samples a
/// pixel are narrow: forests take 3 to 14 % less time, others the same.
constexpr int kBlock = 2;

/// Times the samples that it has, a pixel may get more in a round. With 3 in its place pictures
/// took 4 to 10 % more time to the same error (sapling, tree, forest): their beams were wider.
constexpr std::uint32_t kMostMore = 8;

/// Batches that a pixel gets more at a time. Half of it fits each pixel's wants better, and takes 3
/// to 10 % more time.
constexpr std::uint32_t kUnit = 4;

/// Samples that in passes every pixel has before any has more, and times what it has that it then
/// gets more.
constexpr std::uint32_t kFirst = 16, kPassGrowth = 3;

std::uint32_t whole_batches(int samples) {
  return (static_cast<std::uint32_t>(samples) + DAPPLE_BATCH - 1) / DAPPLE_BATCH * DAPPLE_BATCH;
}

/// `take` each pixel of a block.
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

/// The same for the pixels of each block: their mean, or the greatest.
template <class T, class Join>
std::vector<T> by_block(const std::vector<T>& values, int width, const Join& join) {
  std::vector<T> joined(values.size());
  const int height = static_cast<int>(values.size()) / width;
  tbb::parallel_for(0, (height + kBlock - 1) / kBlock, [&](int row) {
    std::vector<std::uint32_t> block;
    for (int x = 0; x < width; x += kBlock) {
      block.clear();
      for_block(x, row * kBlock, width, height,
                [&](std::uint32_t pixel) { block.push_back(pixel); });
      const T value = join(values, block);
      for (const std::uint32_t pixel : block) joined[pixel] = value;
    }
  });
  return joined;
}

std::vector<float> block_means(const std::vector<float>& values, int width) {
  return by_block(values, width, [](const auto& v, const auto& block) {
    float sum = 0;
    for (const std::uint32_t pixel : block) sum += v[pixel];
    return sum / static_cast<float>(block.size());
  });
}

BatchCounts block_most(const BatchCounts& counts, int width) {
  return by_block(counts, width, [](const auto& v, const auto& block) {
    std::uint32_t most = 0;
    for (const std::uint32_t pixel : block) most = std::max(most, v[pixel]);
    return most;
  });
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
      least_(static_cast<std::uint32_t>(options.spp)),
      most_(least_),
      target_error_(options.target_error),
      target_rmse_(options.target_rmse) {
  samples_.resize(order_.size(), 0);
  if (!is_adaptive()) return;
  // Two batches are the least that tell a variance.
  least_ = std::max(2 * DAPPLE_BATCH, whole_batches(options.spp));
  most_ = std::max(least_, whole_batches(options.max_spp));
}

std::vector<WorkGroup> SamplePlan::least(SampleOrder order) {
  if (all_equal(samples_)) return least_of_all(order);
  std::map<std::uint32_t, WorkGroup> groups;
  for (const std::uint32_t pixel : order_) {
    std::uint32_t& has = samples_[pixel];
    const std::uint32_t more = lacks(has, order);
    if (more == 0) continue;
    WorkGroup& group = groups[more];
    group.samples = more;
    group.work.push_back({pixel, has});
    has += more;
  }
  return in_order(std::move(groups));
}

std::uint32_t SamplePlan::lacks(std::uint32_t has, SampleOrder order) const {
  const std::uint32_t more = least_ - std::min(has, least_);
  return order == SampleOrder::passes ? std::min(more, std::max(kPassGrowth * has, kFirst)) : more;
}

std::vector<WorkGroup> SamplePlan::least_of_all(SampleOrder order) {
  const std::uint32_t has = samples_.front(), more = lacks(has, order);
  if (more == 0) return {};
  std::vector<WorkGroup> groups(1);
  WorkGroup& all = groups.front();
  all.samples = more;
  all.work.resize(order_.size());
  tbb::parallel_for(std::size_t{0}, order_.size(),
                    [&](std::size_t i) { all.work[i] = {order_[i], has}; });
  std::fill(samples_.begin(), samples_.end(), has + more);
  return groups;
}

BatchCounts SamplePlan::wanted(const std::vector<std::vector<float>>& variances,
                               const std::vector<float>& costs) const {
  BatchCounts have(samples_);
  for (std::uint32_t& batches : have) batches /= DAPPLE_BATCH;
  BatchCounts wanted = have;
  const AllocationLimits limits{kUnit, most_ / DAPPLE_BATCH};
  const std::vector<float> block_costs =
      target_rmse_ > 0 ? block_means(costs, width_) : std::vector<float>();
  for (const std::vector<float>& pass : variances) {
    if (target_rmse_ > 0)
      want_rmse(block_means(pass, width_), block_costs, target_rmse_, have, limits, wanted);
    else
      want_error(pass, target_error_, have, limits, wanted);
  }
  return block_most(wanted, width_);
}

std::vector<WorkGroup> SamplePlan::next(const std::vector<std::vector<float>>& variances,
                                        const std::vector<float>& costs) {
  const BatchCounts all = wanted(variances, costs);
  std::map<std::uint32_t, WorkGroup> groups;
  double done = 0, missing = 0;
  for (const std::uint32_t pixel : order_) {
    const std::uint32_t has = samples_[pixel] / DAPPLE_BATCH;
    done += has;
    missing += all[pixel] - has;
    const std::uint32_t most_more = kMostMore * has / kUnit * kUnit;
    const std::uint32_t more = std::min(all[pixel] - has, most_more);
    // By powers of two: few groups, whatever pixels want.
    for (std::uint32_t batches = 1; batches <= more; batches *= 2) {
      if (!(more & batches)) continue;
      WorkGroup& group = groups[batches];
      group.samples = batches * DAPPLE_BATCH;
      group.work.push_back({pixel, samples_[pixel]});
      samples_[pixel] += group.samples;
    }
  }
  fraction_done_ = std::max(fraction_done_, done / (done + missing));
  return in_order(std::move(groups));
}

}  // namespace dapple
