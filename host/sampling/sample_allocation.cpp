#include "sampling/sample_allocation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "sampling/tile_order.hpp"

namespace dapple {
namespace {

/// Pixels that are summed in sequence, so that the result does not depend on threads.
constexpr std::size_t kSumGrain = 4096;

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

void want_equal(const std::vector<float>& variances, double batches, std::uint32_t max,
                BatchCounts& wanted) {
  const std::uint32_t count = rounded_up(batches, max);
  for (std::size_t pixel = 0; pixel < wanted.size(); ++pixel)
    if (variances[pixel] > 0) wanted[pixel] = std::max(wanted[pixel], count);
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
  BatchCounts wanted = block_maxima(have, width);
  for (const std::vector<float>& pass : variances) {
    const std::vector<float> of_blocks = by_block(pass, width, larger<float>);
    if (target.error > 0) {
      want_error(of_blocks, target.error, max, wanted);
    } else if (squared_errors(pass, have) > enough) {
      const double all = squared_errors(pass, BatchCounts(pass.size(), 1));
      want_equal(of_blocks, all / enough, max, wanted);
    }
  }
  return wanted;
}

}  // namespace dapple
