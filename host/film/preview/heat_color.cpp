#include "film/preview/heat_color.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {

Rgb heat_color(double heat) {
  constexpr std::size_t kLast = kHeatRamp.size() - 1;
  const double clamped = heat > 0 ? std::min(heat, 1.0) : 0.0;  // NaN becomes 0
  const double position = clamped * static_cast<double>(kLast);
  const std::size_t index = std::min(static_cast<std::size_t>(position), kLast - 1);
  const double part = position - static_cast<double>(index);
  Rgb color{};
  for (std::size_t c = 0; c < color.size(); ++c) {
    const double mixed = (1 - part) * kHeatRamp[index][c] + part * kHeatRamp[index + 1][c];
    color[c] = static_cast<std::uint8_t>(std::lround(mixed));
  }
  return color;
}

}  // namespace dapple
