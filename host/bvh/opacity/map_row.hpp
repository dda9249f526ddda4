// A row of a coverage map in one, two or four vector registers. In: the row in memory, or two rows.
// Out: the row in registers, stored again, or results by lane; its sum or maximum.
#pragma once

#include <cstring>

#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/register_width.hpp"

namespace dapple {

using FourFloats = float __attribute__((vector_size(16)));
using EightFloats = float __attribute__((vector_size(32)));
using SixteenFloats = float __attribute__((vector_size(64)));

template <int kLanes>
struct RegisterOf;
template <>
struct RegisterOf<4> {
  using Type = FourFloats;
};
template <>
struct RegisterOf<8> {
  using Type = EightFloats;
};
template <>
struct RegisterOf<16> {
  using Type = SixteenFloats;
};

/// Sixteen times 0, and 1. Defined elsewhere, so that g++ 12 does not know the values: a minimum
/// with a constant becomes two instructions, else one.
extern const std::array<float, kMapSize> kZeroRow, kOneRow;

/// A row of floats in registers of `kLanes` floats. Vectors that are wider than a register would be
/// compared lane by lane (g++ 12).
template <int kLanes>
struct Row {
  using Register = typename RegisterOf<kLanes>::Type;
  static constexpr int kParts = kMapSize / kLanes;
  Register part[kParts];

  DAPPLE_ALWAYS_INLINE Row(float value = 0.0f) {
    for (auto& p : part) p = Register{} + value;
  }
  DAPPLE_ALWAYS_INLINE static Row load(const float* from) {
    Row row;
    for (int i = 0; i < kParts; ++i) std::memcpy(&row.part[i], from + i * kLanes, sizeof part[i]);
    return row;
  }
  DAPPLE_ALWAYS_INLINE void store(float* to) const {
    for (int i = 0; i < kParts; ++i) std::memcpy(to + i * kLanes, &part[i], sizeof part[i]);
  }

  DAPPLE_ALWAYS_INLINE static Row zero() { return load(kZeroRow.data()); }
  DAPPLE_ALWAYS_INLINE static Row one() { return load(kOneRow.data()); }
  /// 0, 1, 2 ... 15.
  DAPPLE_ALWAYS_INLINE static Row indices() {
    static constexpr float kIndices[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    static_assert(std::size(kIndices) == kMapSize);
    return load(kIndices);
  }

  DAPPLE_ALWAYS_INLINE Row& operator+=(const Row& b) { return *this = *this + b; }
  DAPPLE_ALWAYS_INLINE Row& operator-=(const Row& b) { return *this = *this - b; }
  DAPPLE_ALWAYS_INLINE friend Row operator+(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] += b.part[i];
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row operator-(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] -= b.part[i];
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row operator*(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] *= b.part[i];
    return a;
  }
  /// `a * Row(b)` would add 0 to b, for the sake of -0.
  DAPPLE_ALWAYS_INLINE friend Row operator*(Row a, float b) {
    for (int i = 0; i < kParts; ++i) a.part[i] *= b;
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row operator+(Row a, float b) {
    for (int i = 0; i < kParts; ++i) a.part[i] += b;
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row operator/(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] /= b.part[i];
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row min(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] = a.part[i] < b.part[i] ? a.part[i] : b.part[i];
    return a;
  }
  DAPPLE_ALWAYS_INLINE friend Row max(Row a, const Row& b) {
    for (int i = 0; i < kParts; ++i) a.part[i] = a.part[i] > b.part[i] ? a.part[i] : b.part[i];
    return a;
  }
  /// 1 where a >= b, 0 elsewhere.
  DAPPLE_ALWAYS_INLINE friend Row at_least(const Row& a, const Row& b) {
    const Register zero{}, one = zero + 1.0f;
    Row out;
    for (int i = 0; i < kParts; ++i) out.part[i] = a.part[i] >= b.part[i] ? one : zero;
    return out;
  }

  /// `value` where a == b, 0 elsewhere.
  DAPPLE_ALWAYS_INLINE friend Row where_equal(const Row& a, float b, float value) {
    const Register zero{}, equal = zero + b, chosen = zero + value;
    Row out;
    for (int i = 0; i < kParts; ++i) out.part[i] = a.part[i] == equal ? chosen : zero;
    return out;
  }

  DAPPLE_ALWAYS_INLINE float sum() const {
    return fold([](auto a, auto b) __attribute__((always_inline)) { return a + b; });
  }
  DAPPLE_ALWAYS_INLINE float max() const {
    return fold([](auto a, auto b) __attribute__((always_inline)) { return a > b ? a : b; });
  }

 private:
  /// Combines one half of the row with the other, repeatedly: a chain of four operations, not
  /// sixteen.
  template <class Combine>
  DAPPLE_ALWAYS_INLINE float fold(Combine combine) const {
    Row row = *this;
    for (int half = kParts / 2; half > 0; half /= 2) {
      for (int i = 0; i < half; ++i) row.part[i] = combine(row.part[i], row.part[i + half]);
    }
    return fold_register(row.part[0], combine);
  }
  template <class Combine>
  DAPPLE_ALWAYS_INLINE static float fold_register(const FourFloats& r, Combine combine) {
    const FourFloats two = combine(r, __builtin_shufflevector(r, r, 2, 3, 0, 1));
    return combine(two[0], two[1]);
  }
  template <class Combine>
  DAPPLE_ALWAYS_INLINE static float fold_register(const EightFloats& r, Combine combine) {
    const FourFloats low = __builtin_shufflevector(r, r, 0, 1, 2, 3);
    const FourFloats high = __builtin_shufflevector(r, r, 4, 5, 6, 7);
    return fold_register(combine(low, high), combine);
  }
  template <class Combine>
  DAPPLE_ALWAYS_INLINE static float fold_register(const SixteenFloats& r, Combine combine) {
    const EightFloats low = __builtin_shufflevector(r, r, 0, 1, 2, 3, 4, 5, 6, 7);
    const EightFloats high = __builtin_shufflevector(r, r, 8, 9, 10, 11, 12, 13, 14, 15);
    return fold_register(combine(low, high), combine);
  }
};

}  // namespace dapple
