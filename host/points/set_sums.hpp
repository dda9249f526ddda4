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
  explicit SetSums(std::size_t count) : sums_(count) {}

  /// Adds the values of a set, and how they fall with depth as parts of `whole(i)`.
  template <class Value, class Whole>
  void add(const Value& value, const Whole& whole) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double x = value(i), all = whole(i);
      const double fall = all > 0 ? all * fall_with_depth(x / all) : 0;
      Sums& of = sums_[i];
      of.value += x;
      of.fall += fall;
      of.squared_value += x * x;
      of.squared_fall += fall * fall;
      of.product += x * fall;
    }
    ++sets_;
  }

  /// Of values in [0,1].
  template <class Value>
  void add(const Value& value) {
    add(value, [](std::size_t) { return 1.0; });
  }

  /// Corrected values are from 0 to `whole(i)`.
  template <class Whole>
  void store(const std::string& name, const BiasCorrection& bias, const Whole& whole,
             std::vector<PointColumn>& columns) const {
    PointColumn values{name, {}}, errors{name + "_error", {}};
    const double change = bias.change(1);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const Sums& of = sums_[i];
      const double fall = of.fall / sets_, corrected = mean(i) + change * fall;
      const double square = of.squared_value + change * (2 * of.product + change * of.squared_fall);
      const double variance = std::max(0.0, square / sets_ - corrected * corrected) / (sets_ - 1);
      const double most = std::max(mean(i), whole(i));  // lights vary from set to set
      values.values.push_back(static_cast<float>(std::clamp(corrected, 0.0, most)));
      errors.values.push_back(
          static_cast<float>(std::hypot(std::sqrt(variance), bias.standard_error(fall))));
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
  [[nodiscard]] double mean(std::size_t i) const { return sums_[i].value / sets_; }

  /// Over the sets of a point.
  struct Sums {
    double value = 0, fall = 0, squared_value = 0, squared_fall = 0, product = 0;
  };
  std::vector<Sums> sums_;
  int sets_ = 0;
};

}  // namespace dapple
