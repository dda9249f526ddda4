// Values at points from independent sets of rays. In: a value for each point from each set. Out:
// two columns, their means and the standard errors of these.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "dapple/points.hpp"
#include "points/bias_correction.hpp"

namespace dapple {

class SetSums {
 public:
  explicit SetSums(std::size_t count) : sums_(count), squares_(count) {}

  template <class Value>
  void add(const Value& value) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double x = value(i);
      sums_[i] += x;
      squares_[i] += x * x;
    }
    ++sets_;
  }

  [[nodiscard]] double mean(std::size_t i) const { return sums_[i] / sets_; }

  /// Values are corrected as parts of `whole(i)`.
  template <class Whole>
  void store(const std::string& name, const BiasCorrection& bias, const Whole& whole,
             std::vector<PointColumn>& columns) const {
    PointColumn values{name, {}}, errors{name + "_error", {}};
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double m = mean(i), all = whole(i);
      const double variance = std::max(0.0, squares_[i] / sets_ - m * m) / (sets_ - 1);
      const double part = all > 0 ? std::min(1.0, m / all) : 1;
      const double of_correction = all * bias.standard_error(part);
      values.values.push_back(static_cast<float>(m + all * (bias.corrected(part) - part)));
      errors.values.push_back(
          static_cast<float>(std::sqrt(variance + of_correction * of_correction)));
    }
    columns.push_back(std::move(values));
    columns.push_back(std::move(errors));
  }

  /// Of values in [0,1].
  void store(const std::string& name, const BiasCorrection& bias,
             std::vector<PointColumn>& columns) const {
    store(
        name, bias, [](std::size_t) { return 1.0; }, columns);
  }

 private:
  std::vector<double> sums_, squares_;
  int sets_ = 0;
};

}  // namespace dapple
