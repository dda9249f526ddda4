// Choices without a state: random bits of two numbers, shares of a sequence that are spread evenly
// over it, and points that are spread over a square. In: an index; out: bits, numbers, yes or no.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace dapple {

/// Random bits from two numbers. Constants: Wellons, "Prospecting for Hash Functions", 2018.
constexpr std::uint32_t hash_of(std::uint32_t a, std::uint32_t b) {
  std::uint32_t x = a * 0x9e3779b1u ^ (b + 0x7f4a7c15u) * 0x85ebca77u;
  x ^= x >> 16;
  x *= 0x21f0aaadu;
  x ^= x >> 15;
  x *= 0x735a2d97u;
  return x ^ x >> 15;
}

/// Multiples of the golden ratio modulo 1, as parts of 2^32: however many of the first are taken,
/// they lie evenly, and agree with no order of what is chosen from, as equal steps would with
/// fronts and backs (Knuth, "The Art of Computer Programming", volume 3, 6.4).
constexpr std::uint32_t golden_multiple(std::uint32_t index) { return (index + 1) * 2654435769u; }

/// The `index`-th choice of a number below `count`.
constexpr std::uint64_t spread_choice(std::uint32_t index, std::uint64_t count) {
  return golden_multiple(index) * count >> 32;
}

/// Steps of the additive sequence R2 (Roberts, "The Unreasonable Effectiveness of Quasirandom
/// Sequences", 2018): 1 / p and 1 / p^2, of which p^3 = p + 1.
inline constexpr std::array<double, 2> kPairSteps{0.7548776662466927, 0.5698402909980532};

/// Two numbers in [0,1) that are evenly spread over the square for any consecutive indices. u, v:
/// those of index 0, from 0 to 1.
inline std::array<double, 2> spread_pair(std::uint64_t index, double u, double v) {
  const auto i = static_cast<double>(index);
  const double a = u + i * kPairSteps[0], b = v + i * kPairSteps[1];
  return {a - std::floor(a), b - std::floor(b)};
}

/// The same, shifted by random bits.
inline std::array<double, 2> spread_pair(std::uint64_t index, std::uint32_t shift) {
  return spread_pair(index, (shift & 0xffffu) / 65536.0, (shift >> 16) / 65536.0);
}

/// Whether `index` belongs to an even share of all numbers; share: [0,1].
constexpr bool is_in_share(std::uint32_t index, double share) {
  return golden_multiple(index) < static_cast<std::uint64_t>(share * 4294967296.0);
}

}  // namespace dapple
