#include "bake/samples/pooled_variance.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

/// Degrees of freedom that the pooled variance counts beside a place's own.
constexpr float kPooledFreedom = 4;

/// Degrees of freedom that the variance of single rays counts beside those of all samples.
constexpr double kRayFreedom = 8;

/// Relative variance of AO of 1/2 from `rays` rays that each find everything or nothing, over 1/4.
/// With many rays per sample these are stratified: the variance falls as rays^-1.5 (Mitchell,
/// "Consequences of Stratified Sampling in Graphics", 1996).
double variance_of_rays(int rays) {
  const double n = std::max(1, rays), few = kRaysPerSample;
  return n <= few ? 1 / n : std::sqrt(few / n) / n;
}

}  // namespace

PooledVariance::PooledVariance(float scale, const Sampling& sampling)
    : scale_(scale),
      of_rays_(variance_of_rays(sampling.rays)),
      several_placements_(sampling.several_placements) {}

void PooledVariance::add(const SideSums& side) {
  const float freedom = side.count() - 1;
  if (freedom < 0.5f) return;
  for (Pool* pool : {&of_interval_[interval(side.mean())], &all_}) {
    pool->squares += double{side.squared_deviations()};
    pool->freedom += double{freedom};
  }
}

PooledVariance& PooledVariance::operator+=(const PooledVariance& other) {
  for (std::size_t i = 0; i < of_interval_.size(); ++i) of_interval_[i] += other.of_interval_[i];
  all_ += other.all_;
  return *this;
}

// Variances are of means over many places: their coefficients are made once.
void PooledVariance::pool() {
  // A few samples may be equal by chance. So the variance of rays that each find everything or
  // nothing counts as much as some samples.
  const double all_freedom = all_.freedom + kRayFreedom;
  const double of_all = all_.squares / all_freedom;
  const double of_rays = double{scale_ * scale_} * of_rays_ * kRayFreedom / all_freedom;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Pool pool = several_placements_ ? Pool{} : around(i);
    const double freedom = pool.freedom + double{kPooledFreedom};
    const double share_of_all = double{kPooledFreedom} / freedom;
    lines_[i] = {static_cast<float>(pool.squares / freedom + share_of_all * of_all),
                 static_cast<float>(share_of_all * of_rays)};
  }
}

float PooledVariance::of(const SideSums& side) const {
  const float own = std::max(0.0f, side.count() - 1);
  return (kPooledFreedom * pooled(side.mean()) + side.squared_deviations()) /
         (kPooledFreedom + own);
}

std::size_t PooledVariance::interval(float value) const {
  return static_cast<std::size_t>(
      std::clamp(static_cast<int>(value / scale_ * kIntervals), 0, kIntervals - 1));
}

// With smaller weights those next to it: some values are only possible where a place's few samples
// are equal.
PooledVariance::Pool PooledVariance::around(std::size_t interval) const {
  constexpr std::array<double, 3> kWeights{1, 0.5, 0.25};
  Pool sum;
  for (std::size_t i = 0; i < of_interval_.size(); ++i) {
    const std::size_t distance = i > interval ? i - interval : interval - i;
    if (distance >= kWeights.size()) continue;
    sum.squares += kWeights[distance] * of_interval_[i].squares;
    sum.freedom += kWeights[distance] * of_interval_[i].freedom;
  }
  return sum;
}

// The value is uncertain, too: hence the clamp.
float PooledVariance::pooled(float value) const {
  const float part = std::clamp(value / scale_, 0.1f, 0.9f);
  const Line& line = lines_[interval(value)];
  return line.of_samples + line.of_rays * (part * (1 - part));
}

}  // namespace dapple
