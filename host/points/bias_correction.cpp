#include "points/bias_correction.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <cstddef>

namespace dapple {

double fall_with_depth(double x) { return x > 0 && x < 1 ? -x * std::log(x) : 0; }

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
  mean_fall_ = fall / count;
  error_ = mean_error_ / mean_fall_;
  measured_ = true;
}

double BiasCorrection::standard_error(double fall) const {
  return std::hypot(error_, local_error_) * fall;
}

void BiasCorrection::set_local_bias(double rmse) {
  if (mean_fall_ > 0) local_error_ = rmse / mean_fall_;
}

std::string BiasCorrection::note(const std::string& quantity) const {
  if (!measured_ || std::fabs(mean_bias_) < 5e-5) return {};
  return fmt::format("prefiltered {} was {:.4f} (+-{:.4f}) too {} on average; corrected", quantity,
                     std::fabs(mean_bias_), mean_error_, mean_bias_ < 0 ? "dark" : "light");
}

}  // namespace dapple
