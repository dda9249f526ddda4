#include "sampling/sample_allocation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dapple {
namespace {

/// Pixels of one partial sum: fixed, so that sums do not depend on threads.
constexpr std::size_t kSumGrain = 4096;

/// Bisections of the interval of the density: to a thousandth of it.
constexpr int kHalvings = 10;

/// The part of the cost of equal samples, times the batches of a pixel, that an allocation by
/// standard deviations must save to be used: it follows estimates, and their errors cost time
/// (experiment 505).
constexpr double kMinSaved = 0.41;

/// Doublings of the density after which every pixel that varies wants the maximum.
constexpr int kDoublings = 60;

/// `have` and whole units more, as near `batches` as `rounding` says, and no more than the most.
std::uint32_t in_units(double batches, std::uint32_t have, double rounding,
                       const AllocationLimits& limits) {
  if (batches <= have || have >= limits.most) return have;
  const double units = std::floor((batches - have) / limits.unit + rounding);
  const double all = have + units * limits.unit;
  return all < limits.most ? static_cast<std::uint32_t>(all) : limits.most;
}

/// Of values of pixels, in an order that does not depend on threads.
template <class Value>
double sum_over(std::size_t pixels, const Value& value) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_deterministic_reduce(
      Range(0, pixels, kSumGrain), 0.0,
      [&](const Range& range, double partial) {
        for (std::size_t pixel = range.begin(); pixel < range.end(); ++pixel)
          partial += value(pixel);
        return partial;
      },
      std::plus<>());
}

/// One pass, whose pixels are given batches by the density: so many for a deviation of 1 at a cost
/// of 1.
class ByDeviation {
 public:
  ByDeviation(const std::vector<float>& variances, const std::vector<float>& costs,
              const BatchCounts& have, const AllocationLimits& limits, const BatchCounts& wanted)
      : variances_(variances), have_(have), limits_(limits), wanted_(wanted) {
    shares_.resize(variances.size());
    std::transform(variances.begin(), variances.end(), costs.begin(), shares_.begin(),
                   [](float variance, float cost) { return std::sqrt(variance / cost); });
  }

  [[nodiscard]] std::uint32_t batches(std::size_t pixel, double density) const {
    return std::max(wanted_[pixel], in_units(density * shares_[pixel], have_[pixel], 0.5, limits_));
  }
  [[nodiscard]] double squared_error_sum(double density) const {
    return sum_over(shares_.size(), [&](std::size_t pixel) {
      return double{variances_[pixel]} / batches(pixel, density);
    });
  }
  /// The squared errors' sum, times the density, if every pixel began at none and had no most.
  [[nodiscard]] double free_error_sum() const {
    return sum_over(shares_.size(), [&](std::size_t pixel) {
      return shares_[pixel] > 0 ? double{variances_[pixel]} / shares_[pixel] : 0.0;
    });
  }

 private:
  const std::vector<float>& variances_;
  const BatchCounts& have_;
  const AllocationLimits& limits_;
  const BatchCounts& wanted_;
  std::vector<float> shares_;
};

/// The least density whose squared errors add up to no more than `enough`.
double min_density(const ByDeviation& pass, double enough) {
  double high = pass.free_error_sum() / enough, low = 0;
  for (int i = 0; i < kDoublings && pass.squared_error_sum(high) > enough; ++i) {
    low = high;
    high *= 2;
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (pass.squared_error_sum(middle) > enough ? low : high) = middle;
  }
  return high;
}

BatchCounts wanted_by_deviation(const std::vector<float>& variances,
                                const std::vector<float>& costs, double enough,
                                const BatchCounts& have, const AllocationLimits& limits,
                                const BatchCounts& wanted) {
  const ByDeviation pass(variances, costs, have, limits, wanted);
  const double density = min_density(pass, enough);
  BatchCounts raised(wanted.size());
  for (std::size_t pixel = 0; pixel < raised.size(); ++pixel)
    raised[pixel] = pass.batches(pixel, density);
  return raised;
}

/// Batches for all that vary alike, not rounded.
double batches_alike(const std::vector<float>& variances, double enough,
                     const AllocationLimits& limits) {
  const double sum =
      sum_over(variances.size(), [&](std::size_t p) { return double{variances[p]}; });
  return std::min(sum / enough, static_cast<double>(limits.most));
}

BatchCounts wanted_alike(const std::vector<float>& variances, double batches,
                         const BatchCounts& wanted) {
  BatchCounts raised = wanted;
  for (std::size_t pixel = 0; pixel < raised.size(); ++pixel) {
    if (variances[pixel] > 0)
      raised[pixel] = std::max(raised[pixel], static_cast<std::uint32_t>(std::ceil(batches)));
  }
  return raised;
}

/// The part of the cost of so many batches for all that vary which `counts` save, both beyond
/// what is wanted already.
double saved_by(const BatchCounts& counts, double batches, const std::vector<float>& variances,
                const std::vector<float>& costs, const BatchCounts& wanted) {
  const double cost = sum_over(
      counts.size(), [&](std::size_t p) { return double{costs[p]} * (counts[p] - wanted[p]); });
  const double alike = sum_over(counts.size(), [&](std::size_t p) {
    return variances[p] > 0 ? costs[p] * std::max(0.0, batches - wanted[p]) : 0.0;
  });
  return 1.0 - cost / alike;
}

/// The mean of those that pixels have which vary.
double batches_where_varied(const std::vector<float>& variances, const BatchCounts& have) {
  const auto varies = [&](std::size_t p) { return variances[p] > 0 ? 1.0 : 0.0; };
  return sum_over(have.size(), [&](std::size_t p) { return varies(p) * have[p]; }) /
         sum_over(have.size(), varies);
}

}  // namespace

void want_error(const std::vector<float>& variances, float target, const BatchCounts& have,
                const AllocationLimits& limits, BatchCounts& wanted) {
  for (std::size_t pixel = 0; pixel < wanted.size(); ++pixel) {
    // Rounded up, where whole units leave nothing over.
    const double enough = std::ceil(double{variances[pixel]} / (double{target} * target));
    const double all_but_one = 1.0 - 1.0 / limits.unit;
    wanted[pixel] = std::max(wanted[pixel], in_units(enough, have[pixel], all_but_one, limits));
  }
}

double squared_errors(const std::vector<float>& variances, const BatchCounts& batches) {
  return sum_over(variances.size(),
                  [&](std::size_t pixel) { return double{variances[pixel]} / batches[pixel]; });
}

void want_rmse(const std::vector<float>& variances, const std::vector<float>& costs, double enough,
               const BatchCounts& have, const AllocationLimits& limits, BatchCounts& wanted) {
  if (squared_errors(variances, wanted) <= enough) return;
  BatchCounts by_deviation = wanted_by_deviation(variances, costs, enough, have, limits, wanted);
  const double batches = batches_alike(variances, enough, limits);
  const double saved = saved_by(by_deviation, batches, variances, costs, wanted);
  if (saved * batches_where_varied(variances, have) >= kMinSaved)
    wanted = std::move(by_deviation);
  else
    wanted = wanted_alike(variances, batches, wanted);
}

}  // namespace dapple
