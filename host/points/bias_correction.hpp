// Takes the mean bias of prefiltering out of what points measure. In: one quantity at some points,
// exact and prefiltered by the same rays. Out: corrected values and the standard error of the
// correction. A ratio estimator: Cochran, "Sampling Techniques", 1977, chapter 6.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dapple {

/// How fast a transmittance in [0,1] falls when its optical depth grows by a factor: -x log(x). 0
/// for others.
double fall_with_depth(double transmittance);

/// Prefiltered optical depths are taken to be wrong by one factor, 1 + e. A transmittance is then
/// wrong by e times its fall: nothing where nothing occludes. A mean of several values has the mean
/// of their falls, which is less than the fall of the mean.
class BiasCorrection {
 public:
  /// Changes nothing.
  BiasCorrection() = default;
  /// Values in [0,1], of the same rays in the same order. `points`: which point each value is of;
  /// those of one point have a bias in common. Empty: each is of another point. `share`: of all
  /// points, how many these are, [0,1].
  BiasCorrection(std::span<const double> exact, std::span<const double> prefiltered,
                 std::span<const std::uint32_t> points = {}, double share = 0);

  /// What must be added to a prefiltered value in [0,1] with this fall.
  [[nodiscard]] double change(double fall) const { return change_ * fall; }
  /// Of a corrected value with this fall: of the change, and of what it leaves of the bias.
  [[nodiscard]] double standard_error(double fall) const;

  /// `rmse`: of what the correction leaves of the bias of single values, beside their noise.
  void set_local_bias(double rmse);

  [[nodiscard]] bool is_measured() const { return measured_; }
  /// Prefiltered less exact, before the correction, and its standard error.
  [[nodiscard]] double mean_bias() const { return mean_bias_; }
  [[nodiscard]] double mean_error() const { return mean_error_; }

  /// One line about the mean bias and its standard error; empty if nothing was measured.
  [[nodiscard]] std::string note(const std::string& quantity) const;

 private:
  double change_ = 0, error_ = 0;           // by fall
  double mean_fall_ = 0, local_error_ = 0;  // the latter by fall, too
  double mean_bias_ = 0, mean_error_ = 0;
  bool measured_ = false;
};

}  // namespace dapple
