// Adds two 64-bit numbers that come from files and may be damaged. The sum wraps around beyond the
// range, where C++ does not define the sum of signed numbers. In: two numbers. Out: their sum.
#pragma once

#include <cstdint>

namespace dapple {

inline std::int64_t wrapped_sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

}  // namespace dapple
