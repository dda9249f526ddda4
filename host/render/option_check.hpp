// Ranges of options, for the checks of all kinds of options. In: a value and its range. Out:
// nothing, or an Error.
#pragma once

#include <fmt/format.h>

#include <string_view>

#include "dapple/error.hpp"
#include "dapple/options.hpp"
#include "scene/check/enumerator.hpp"

namespace dapple {

/// Throws Error usage if `value` is not in [low, high], or is NaN. `name`: such as "--spp".
inline void check_range(std::string_view name, double value, double low, double high) {
  if (value >= low && value <= high) return;  // false for NaN
  throw Error(ErrorKind::usage, fmt::format("{} is {:.7g}; it must be from {:.7g} to {:.7g}", name,
                                            value, low, high));
}

/// Throws Error usage if an enumeration, whose last enumerator is `last`, has no such value.
template <class Enumeration>
void check_enumerator(std::string_view name, Enumeration value, Enumeration last) {
  if (is_enumerator(value, last)) return;
  throw Error(ErrorKind::usage, fmt::format("{} has no value {}", name, static_cast<int>(value)));
}

/// The options of rays that bakes and points have by the same names.
template <class Options>
void check_ray_options(const Options& options) {
  check_enumerator("--estimator", options.estimator, Estimator::prefiltered);
  check_range("--footprint", double{options.footprint}, 0, 1e6);
  check_range("--report-bias", double{options.report_bias}, 0, 1);
  check_range("--ao-distance", options.distance, 0, 1e30f);
  check_range("--ao-falloff", double{options.falloff}, 0, 100);
  if (options.falloff > 0 && !(options.distance > 0))
    throw Error(ErrorKind::usage, "--ao-falloff needs --ao-distance");
}

}  // namespace dapple
