// Sums of fixed-point numbers that may exceed 64 bits, as those of damaged files do.
#pragma once

#include <cstdint>
#include <limits>

namespace dapple {

/// Modulo 2^64.
inline std::int64_t wrapped_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

/// Stops at the largest and smallest number.
inline std::int64_t saturated_sum(std::int64_t a, std::int64_t b) {
  using Limits = std::numeric_limits<std::int64_t>;
  if (a > 0 && b > Limits::max() - a) return Limits::max();
  if (a < 0 && b < Limits::min() - a) return Limits::min();
  return a + b;
}

}  // namespace dapple
