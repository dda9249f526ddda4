#include "sampling/sample_allocation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "sampling/tile_order.hpp"

namespace dapple {
namespace {

/// Pixels that are summed in sequence, so that the result does not depend on threads.
constexpr std::size_t kSumGrain = 4096;

/// A target RMSE multiplies numbers of batches by this at most, before variances are looked at
/// again.
constexpr std::uint32_t kMaxFactor = 8;

/// Numbers are multiplied by 2, 4 or 8 if this times the ratio of squared errors is as much:
/// squared errors fall by more than the factor, because more samples are better stratified.
constexpr double kAlmost = 1.15;

/// Bits of a positive float that do not count when blocks are sorted: of 23 those that are below
/// 1 %.
constexpr int kBinShift = 16;

std::uint32_t rounded_up(double batches, std::uint32_t max) {
  return batches < max ? static_cast<std::uint32_t>(std::ceil(batches)) : max;
}

template <class T>
T larger(T a, T b) {
  return std::max(a, b);
}

}  // namespace

double squared_errors(const std::vector<float>& variances, const BatchCounts& batches) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_deterministic_reduce(
      Range(0, variances.size(), kSumGrain), 0.0,
      [&](const Range& range, double partial) {
        for (std::size_t pixel = range.begin(); pixel < range.end(); ++pixel)
          partial += double{variances[pixel]} / batches[pixel];
        return partial;
      },
      std::plus<>());
}

void want_multiple(const std::vector<float>& variances, std::uint32_t factor,
                   const BatchCounts& have, std::uint32_t max, BatchCounts& wanted) {
  for (std::size_t block = 0; block < wanted.size(); ++block)
    if (variances[block] > 0)
      wanted[block] = std::max(wanted[block], std::min(factor * have[block], max));
}

// Blocks are sorted by the upper bits of what a batch brings: within 1 % in order, in linear time.
void want_doubles(const std::vector<float>& falls, double excess, const BatchCounts& have,
                  std::uint32_t max, BatchCounts& wanted) {
  const auto bin_of = [&](std::size_t block) {
    const float of_batch = falls[block] / static_cast<float>(have[block]);
    return std::bit_cast<std::uint32_t>(of_batch) >> kBinShift;
  };
  const auto can_fall = [&](std::size_t block) { return falls[block] > 0 && have[block] < max; };
  std::vector<double> of_bins(std::size_t{1} << (32 - kBinShift));
  for (std::size_t block = 0; block < wanted.size(); ++block)
    if (can_fall(block)) of_bins[bin_of(block)] += double{falls[block]};
  std::size_t first = of_bins.size();
  for (double fallen = 0; first > 0 && fallen < excess;) fallen += of_bins[--first];
  for (std::size_t block = 0; block < wanted.size(); ++block)
    if (can_fall(block) && bin_of(block) >= first)
      wanted[block] = std::max(wanted[block], std::min(2 * have[block], max));
}

void want_error(const std::vector<float>& variances, float target, std::uint32_t max,
                BatchCounts& wanted) {
  const double enough = 1.0 / (double{target} * target);
  for (std::size_t pixel = 0; pixel < wanted.size(); ++pixel)
    wanted[pixel] = std::max(wanted[pixel], rounded_up(variances[pixel] * enough, max));
}

double squared_target(float rmse, std::size_t pixels) {
  return double{rmse} * rmse * static_cast<double>(pixels);
}

BatchCounts block_maxima(const BatchCounts& batches, int width) {
  return by_block(batches, width, larger<std::uint32_t>);
}

BatchCounts allocate_batches(const PassVariances& variances, const BatchCounts& have, int width,
                             ErrorTarget target, std::uint32_t max) {
  const double enough = squared_target(target.rmse, have.size());
  const BatchCounts of_blocks = block_maxima(have, width);
  BatchCounts wanted = of_blocks;
  for (const std::vector<float>& pass : variances) {
    if (target.error > 0) {
      want_error(by_block(pass, width, larger<float>), target.error, max, wanted);
      continue;
    }
    const double square = squared_errors(pass, have), ratio = square / enough;
    if (kAlmost * ratio >= 2) {
      const auto factor =
          std::bit_floor(static_cast<std::uint32_t>(std::min(kAlmost * ratio, double{kMaxFactor})));
      want_multiple(by_block(pass, width, larger<float>), factor, of_blocks, max, wanted);
    } else if (ratio > 1) {
      std::vector<float> falls(pass.size());
      for (std::size_t p = 0; p < pass.size(); ++p)
        falls[p] = 0.5f * pass[p] / static_cast<float>(have[p]);
      want_doubles(by_block(falls, width, std::plus<>()), square - enough, of_blocks, max, wanted);
    }
  }
  return wanted;
}

}  // namespace dapple
