// The input of the BVH builder, and the boxes with which it computes: eight floats each, so that
// the union of two boxes is a single vector minimum.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "dapple/scene.hpp"

namespace dapple {

/// The box of one primitive and its index in the caller's list. The bytes are those of a Box8,
/// except lanes 3 and 7.
struct alignas(32) PrimitiveBox {
  float lower[3];  // not V3f, which is not trivially copyable
  std::uint32_t primitive;
  float minus_upper[3];
  std::uint32_t spare;
};

inline PrimitiveBox primitive_box(const Box3f& box, std::uint32_t primitive) {
  return {{box.min.x, box.min.y, box.min.z}, primitive, {-box.max.x, -box.max.y, -box.max.z}, 0};
}

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

/// A box as lower bounds, then negated upper bounds, so that one minimum joins both. Lanes 3 and 7
/// have no meaning. Not initialized: begin with clear(). Passed by reference everywhere: vectors
/// wider than the registers of the instruction set have no calling convention, nor an alignment.
struct alignas(32) Box8 {
  Float8 bounds;

  void clear() { bounds = Float8{} + std::numeric_limits<float>::infinity(); }
  void add(const Float8& other) { bounds = other < bounds ? other : bounds; }
  void add(const Box8& other) { add(other.bounds); }

  [[nodiscard]] Box3f box() const {
    return {V3f(bounds[0], bounds[1], bounds[2]), V3f(-bounds[4], -bounds[5], -bounds[6])};
  }

  /// xy + yz + zx, half of the surface; not for empty boxes.
  [[nodiscard]] float half_area() const {
    Float4 half[2];
    std::memcpy(half, &bounds, sizeof half);
    const Float4 size = half[0] + half[1];  // negated; products of two sizes are positive
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

/// Loads the box and sets lanes 3 and 7 to 0: they hold integers, which may be slow or NaN as
/// floats.
inline void load_box(const PrimitiveBox& prim, Float8& box) {
  Int8 bits;
  static_assert(sizeof(PrimitiveBox) == sizeof bits && std::is_trivially_copyable_v<PrimitiveBox>);
  std::memcpy(&bits, &prim, sizeof bits);
  bits &= Int8{-1, -1, -1, 0, -1, -1, -1, 0};
  std::memcpy(&box, &bits, sizeof box);
}

/// Computes twice the centre of a box, as the bounds of this point in the layout of Box8.
inline void centre2_of(const Float8& box, Float8& centre2) {
  centre2 = box - __builtin_shufflevector(box, box, 4, 5, 6, 7, 0, 1, 2, 3);
}

/// Returns half of the surface area of the box: xy + yz + zx, in square metres; 0 for an empty box.
inline float half_area(const Box3f& box) {
  if (box.isEmpty()) return 0.0f;
  const V3f size = box.max - box.min;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace dapple
