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
  explicit SetSums(std::size_t count) : sums_(count), squares_(count), falls_(count) {}

  /// Adds the values of a set, and how they fall with depth as parts of `whole(i)`.
  template <class Value, class Whole>
  void add(const Value& value, const Whole& whole) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double x = value(i), all = whole(i);
      sums_[i] += x;
      squares_[i] += x * x;
      if (all > 0) falls_[i] += all * fall_with_depth(x / all);
    }
    ++sets_;
  }

  /// Of values in [0,1].
  template <class Value>
  void add(const Value& value) {
    add(value, [](std::size_t) { return 1.0; });
  }

  [[nodiscard]] double mean(std::size_t i) const { return sums_[i] / sets_; }

  /// Corrected values are from 0 to `whole(i)`.
  template <class Whole>
  void store(const std::string& name, const BiasCorrection& bias, const Whole& whole,
             std::vector<PointColumn>& columns) const {
    PointColumn values{name, {}}, errors{name + "_error", {}};
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double m = mean(i), all = whole(i);
      const double variance = std::max(0.0, squares_[i] / sets_ - m * m) / (sets_ - 1);
      const double fall = falls_[i] / sets_, of_correction = bias.standard_error(fall);
      const double most = std::max(m, all);  // lights vary from set to set
      values.values.push_back(static_cast<float>(std::clamp(m + bias.change(fall), 0.0, most)));
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
  std::vector<double> sums_, squares_, falls_;
  int sets_ = 0;
};

}  // namespace dapple
