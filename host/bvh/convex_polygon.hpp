// A triangle of the plane and what cuts leave of it (Sutherland and Hodgman, "Reentrant Polygon
// Clipping", 1974).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "dapple/scene.hpp"

namespace dapple {

struct ConvexPolygon {
  static constexpr std::size_t kMostCuts = 8;  ///< each adds a corner at most
  std::array<V2f, 3 + kMostCuts> corner;
  std::size_t count = 3;

  ConvexPolygon(V2f a, V2f b, V2f c) : corner{a, b, c} {}

  /// Cuts off where `beyond`, linear in the place, is above 0.
  template <class Beyond>
  void cut(const Beyond& beyond) {
    const ConvexPolygon before = *this;
    count = 0;
    for (std::size_t i = 0; i < before.count; ++i) {
      const V2f &from = before.corner[i], &to = before.corner[(i + 1) % before.count];
      const float here = beyond(from), there = beyond(to);
      if (here <= 0.0f) corner[count++] = from;
      if ((here < 0.0f && there > 0.0f) || (here > 0.0f && there < 0.0f))
        corner[count++] = from + (to - from) * (here / (here - there));
    }
  }

  [[nodiscard]] float area() const {
    float twice = 0;
    for (std::size_t i = 2; i < count; ++i)
      twice += (corner[i - 1] - corner[0]).cross(corner[i] - corner[0]);
    return 0.5f * std::fabs(twice);
  }
};

}  // namespace dapple
