// Ranges of options, for the checks of all kinds of options. In: a value and its range. Out:
// nothing, or an Error.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "dapple/error.hpp"

namespace dapple {

/// Throws Error usage if `value` is not in [low, high], or is NaN. `name`: such as "--spp".
inline void check_range(std::string_view name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  throw Error(ErrorKind::usage, fmt::format("{} is {:.7g}; it must be from {:.7g} to {:.7g}", name,
                                            value, low, high));
}

}  // namespace dapple
