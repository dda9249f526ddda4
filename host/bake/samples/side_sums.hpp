// Weighted sums over the samples of one side of a place. In: samples' values. Out: their mean, and
// how far they are from it.
#pragma once

#include <algorithm>

#include "bake/samples/sample_tracer.hpp"

namespace dapple {

struct SideSums {
  float weight = 0, weight_squares = 0, sum = 0, sum_squares = 0;
  V3f bent{0, 0, 0};

  void add(float w, const SideValue& value) {
    weight += w;
    weight_squares += w * w;
    sum += w * value.scalar;
    sum_squares += w * value.scalar * value.scalar;
    bent += value.bent * w;
  }

  [[nodiscard]] float mean() const { return weight > 0 ? sum / weight : 0; }

  /// Number of samples of equal weight that would have the same standard error.
  [[nodiscard]] float count() const {
    return weight_squares > 0 ? weight * weight / weight_squares : 0;
  }

  /// Sum of squared deviations, for count() - 1 degrees of freedom.
  [[nodiscard]] float squared_deviations() const {
    return weight > 0 ? std::max(0.0f, sum_squares / weight - mean() * mean()) * count() : 0.0f;
  }
};

/// Of both sides of a place.
struct BothSides {
  SideSums front, back;
  float inside_weight = 0, inside_squares = 0;  ///< of samples inside closed geometry
  [[nodiscard]] float inside_count() const {
    return inside_squares > 0 ? inside_weight * inside_weight / inside_squares : 0;
  }
};

}  // namespace dapple
