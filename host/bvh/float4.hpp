// Four floats in one register, for the builder's inner loops: boxes as two of them.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

#include "dapple/scene.hpp"

namespace dapple {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 min4(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max4(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 splat4(float x) { return Float4{x, x, x, x}; }

/// A box whose fourth lane means nothing. Not initialized: begin with empty_box4().
struct Box4 {
  Float4 lower, upper;

  void add(Float4 low, Float4 high) {
    lower = min4(lower, low);
    upper = max4(upper, high);
  }
  void add(const Box4& other) { add(other.lower, other.upper); }

  [[nodiscard]] Box3f box() const {
    return {V3f(lower[0], lower[1], lower[2]), V3f(upper[0], upper[1], upper[2])};
  }

  /// xy + yz + zx; not for empty boxes.
  [[nodiscard]] float half_area() const {
    const Float4 size = upper - lower;
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

inline Box4 empty_box4() {
  const float infinity = std::numeric_limits<float>::infinity();
  return {splat4(infinity), splat4(-infinity)};
}

}  // namespace dapple
