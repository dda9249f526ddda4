// The sum of two fixed-point numbers of files: they may be anything, and C++ does not define what
// signed numbers do beyond their range.
#pragma once

#include <cstdint>

namespace dapple {

inline std::int64_t wrapped_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace dapple
