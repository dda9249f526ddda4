// Compares arrays by their bits: NaN equals itself, and -0 is not 0.
#pragma once

#include <cstring>

namespace dapple {

template <class Array>
bool same_bits(const Array& a, const Array& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

}  // namespace dapple
