// Areas of a mesh where an instance places it. Instances that scale axes unevenly change the shares
// that parts of a surface have in it.
#pragma once

#include <array>
#include <cmath>

#include "dapple/scene.hpp"

namespace dapple {

class PlacedAreas {
 public:
  /// A matrix that makes all areas zero, or is not finite, counts as even.
  explicit PlacedAreas(const M44f& to_world) {
    std::array<Imath::V3d, 3> axis;
    for (int i = 0; i < 3; ++i)
      axis[static_cast<std::size_t>(i)] = {to_world[i][0], to_world[i][1], to_world[i][2]};
    const std::array<Imath::V3d, 3> cofactors{axis[1].cross(axis[2]), axis[2].cross(axis[0]),
                                              axis[0].cross(axis[1])};
    const double mean =
        std::sqrt((cofactors[0].length2() + cofactors[1].length2() + cofactors[2].length2()) / 3);
    if (!(mean > 0) || !std::isfinite(mean)) return;
    is_even_ = true;
    for (std::size_t i = 0; i < 3; ++i) cofactors_[i] = V3f(cofactors[i] / mean);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        is_even_ = is_even_ &&
                   std::fabs(cofactors_[i].dot(cofactors_[k]) - (i == k ? 1.0f : 0.0f)) < kEven;
  }

  /// Whether the instance scales all directions alike.
  [[nodiscard]] bool is_even() const { return is_even_; }

  /// How large a part with the unit normal `normal` is there, relative to its area in object space
  /// and to other parts. 1 if is_even().
  [[nodiscard]] float scale_of(const V3f& normal) const {
    if (is_even_) return 1;
    return (cofactors_[0] * normal.x + cofactors_[1] * normal.y + cofactors_[2] * normal.z)
        .length();
  }

 private:
  static constexpr float kEven = 1e-4f;  // roundings of rotations

  std::array<V3f, 3> cofactors_;
  bool is_even_ = true;
};

}  // namespace dapple
