#include "points/bias_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace dapple {
namespace {

/// How fast a transmittance falls when its optical depth grows by a factor.
double fall_with_depth(double x) { return x > 0 && x < 1 ? -x * std::log(x) : 0; }

}  // namespace

BiasCorrection::BiasCorrection(std::span<const double> exact, std::span<const double> prefiltered) {
  assert(exact.size() == prefiltered.size());
  double difference = 0, fall = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    difference += exact[i] - prefiltered[i];
    fall += fall_with_depth(prefiltered[i]);
  }
  if (exact.size() < 2 || !(fall > 0)) return;
  change_ = difference / fall;
  double residual = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double r = exact[i] - prefiltered[i] - change_ * fall_with_depth(prefiltered[i]);
    residual += r * r;
  }
  const auto count = static_cast<double>(exact.size());
  mean_bias_ = -difference / count;
  mean_error_ = std::sqrt(residual / (count * (count - 1)));
  error_ = mean_error_ * count / fall;
  measured_ = true;
}

double BiasCorrection::corrected(double prefiltered) const {
  if (!measured_) return prefiltered;
  return std::clamp(prefiltered + change_ * fall_with_depth(prefiltered), 0.0, 1.0);
}

double BiasCorrection::standard_error(double prefiltered) const {
  return error_ * fall_with_depth(prefiltered);
}

std::string BiasCorrection::note(const std::string& quantity) const {
  if (!measured_ || std::fabs(mean_bias_) < 5e-5) return {};
  return fmt::format("prefiltered {} was {:.4f} (+-{:.4f}) too {} on average; corrected", quantity,
                     std::fabs(mean_bias_), mean_error_, mean_bias_ < 0 ? "dark" : "light");
}

}  // namespace dapple
