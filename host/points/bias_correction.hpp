// Takes the mean bias of prefiltering out of what points measure. In: one quantity at some points,
// exact and prefiltered by the same rays. Out: corrected values and the standard error of the
// correction. A ratio estimator: Cochran, "Sampling Techniques", 1977, chapter 6.
#pragma once

#include <span>
#include <string>

namespace dapple {

/// Prefiltered optical depths are taken to be wrong by one factor, 1 + e. A transmittance x is then
/// wrong by e times -x log(x): nothing where nothing occludes.
class BiasCorrection {
 public:
  /// Changes nothing.
  BiasCorrection() = default;
  /// Values in [0,1], of the same rays in the same order.
  BiasCorrection(std::span<const double> exact, std::span<const double> prefiltered);

  /// The corrected value of a prefiltered one in [0,1].
  [[nodiscard]] double corrected(double prefiltered) const;
  [[nodiscard]] double standard_error(double prefiltered) const;

  [[nodiscard]] bool is_measured() const { return measured_; }
  /// Prefiltered less exact, before the correction, and its standard error.
  [[nodiscard]] double mean_bias() const { return mean_bias_; }
  [[nodiscard]] double mean_error() const { return mean_error_; }

  /// One line about the mean bias and its standard error; empty if nothing was measured.
  [[nodiscard]] std::string note(const std::string& quantity) const;

 private:
  double change_ = 0, error_ = 0;
  double mean_bias_ = 0, mean_error_ = 0;
  bool measured_ = false;
};

}  // namespace dapple
