#include "points/bias_correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace dapple {
namespace {

/// Residuals of one point.
struct PointResiduals {
  double count = 0, sum = 0, squares = 0;

  /// Variance of `sum`, if the point's bias is known.
  [[nodiscard]] double variance() const {
    if (count < 2) return squares;
    return std::max(0.0, squares - sum * sum / count) * count / (count - 1);
  }
};

/// Of the sum of all residuals: points are a sample of all, `share` of them, and values one of each
/// point's (two-stage sampling: Cochran, "Sampling Techniques", 1977, chapter 10).
double variance_of_sum(std::span<const double> residuals, std::span<const std::uint32_t> points,
                       double share) {
  std::vector<PointResiduals> of_points(
      points.empty() ? residuals.size() : *std::max_element(points.begin(), points.end()) + 1);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    PointResiduals& of_point = of_points[points.empty() ? i : points[i]];
    of_point.count += 1;
    of_point.sum += residuals[i];
    of_point.squares += residuals[i] * residuals[i];
  }
  double count = 0, between = 0, within = 0;
  for (const PointResiduals& of_point : of_points) {
    if (of_point.count > 0) count += 1;
    between += of_point.sum * of_point.sum;
    within += of_point.variance();
  }
  if (count > 1) between *= count / (count - 1);
  return (1 - share) * between + share * within;
}

}  // namespace

double fall_with_depth(double x) { return x > 0 && x < 1 ? -x * std::log(x) : 0; }

BiasCorrection::BiasCorrection(std::span<const double> exact, std::span<const double> prefiltered,
                               std::span<const std::uint32_t> points, double share) {
  assert(points.empty() || points.size() == exact.size());
  assert(exact.size() == prefiltered.size());
  double difference = 0, fall = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    difference += exact[i] - prefiltered[i];
    fall += fall_with_depth(prefiltered[i]);
  }
  if (exact.size() < 2 || !(fall > 0)) return;
  change_ = difference / fall;
  std::vector<double> residuals(exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i)
    residuals[i] = exact[i] - prefiltered[i] - change_ * fall_with_depth(prefiltered[i]);
  const auto count = static_cast<double>(exact.size());
  mean_bias_ = -difference / count;
  mean_error_ = std::sqrt(variance_of_sum(residuals, points, share)) / count;
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
