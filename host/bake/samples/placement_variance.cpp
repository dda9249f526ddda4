#include "bake/samples/placement_variance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

/// Values that are kept for comparison at most.
constexpr std::size_t kMostValues = 1u << 20;

/// The assumption that placements do not differ counts as much as so many pairs of samples.
constexpr double kPairsOfPrior = 1;

}  // namespace

PlacementVariance::PlacementVariance(std::size_t elements, std::uint32_t placements)
    : placements_(placements) {
  const std::size_t values = 2 * std::size_t{placements};  // of an element
  if (placements < 2 || values > kMostValues) return;
  stride_ = elements * values / kMostValues + 1;
  sides_.resize(2 * (elements / stride_ + 1));
  last_.resize(sides_.size() * placements, std::numeric_limits<float>::quiet_NaN());
}

void PlacementVariance::add(std::uint32_t element, std::uint32_t placement,
                            const SurfaceSample& sample, float front, float back) {
  if (stride_ == 0 || element % stride_ != 0) return;
  const std::size_t side = 2 * (element / stride_);
  if (sample.front) add_value(side, placement, front);
  if (sample.back) add_value(side + 1, placement, back);
}

void PlacementVariance::add_value(std::size_t side, std::uint32_t placement, float value) {
  Side& of = sides_[side];
  if (of.count++ == 0) of.first = double{value};
  const double relative = double{value} - of.first;
  of.sum += relative;
  of.squares += relative * relative;
  float& last = last_[side * placements_ + placement];
  if (!std::isnan(last)) {
    const double difference = double{value} - double{last};
    of.pair_squares += 0.5 * difference * difference;
    ++of.pairs;
  }
  last = value;
}

float PlacementVariance::share_within() const {
  double pairs = 0, pair_squares = 0, freedom = 0, squares = 0;
  for (const Side& side : sides_) {
    if (side.pairs == 0) continue;
    pairs += side.pairs;
    pair_squares += side.pair_squares;
    freedom += side.count - 1;
    squares += std::max(0.0, side.squares - side.sum * side.sum / side.count);
  }
  if (!(squares > 0)) return 1;
  const double all = squares / freedom;
  const double within = (pair_squares + kPairsOfPrior * all) / (pairs + kPairsOfPrior);
  return static_cast<float>(std::min(1.0, within / all));
}

float variance_factor(std::uint32_t samples, std::uint32_t placements, float share_within,
                      float balance) {
  if (samples == 0 || placements < 2) return 1;
  const double n = samples, all = placements, last = samples % placements;
  const double between = 1 - double{balance} * (1 - last * (all - last) / (all * n));
  return static_cast<float>(double{share_within} + (1 - double{share_within}) * between);
}

}  // namespace dapple
