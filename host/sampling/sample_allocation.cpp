#include "sampling/sample_allocation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dapple {
namespace {

/// Pixels that are summed in sequence, so that the result does not depend on threads.
constexpr std::size_t kSumGrain = 4096;

std::uint32_t rounded_up(double batches, std::uint32_t max) {
  return batches < max ? static_cast<std::uint32_t>(std::ceil(batches)) : max;
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

}  // namespace dapple
