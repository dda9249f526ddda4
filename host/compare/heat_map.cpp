#include "compare/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// kNoNumber stays: std::max(NaN, x) is NaN, and is asked in that order.
double larger_difference(double so_far, float a, float b) {
  if (a == b) return so_far;  // infinities included
  if (!std::isfinite(a) || !std::isfinite(b)) return kNoNumber;
  return std::max(so_far, std::abs(static_cast<double>(a) - static_cast<double>(b)));
}

}  // namespace

Rgb heat_color(double heat) {
  constexpr std::size_t kLast = kHeatRamp.size() - 1;
  const double clamped = heat > 0 ? std::min(heat, 1.0) : 0.0;  // NaN becomes 0
  const double place = clamped * static_cast<double>(kLast);
  const std::size_t index = std::min(static_cast<std::size_t>(place), kLast - 1);
  const double part = place - static_cast<double>(index);
  Rgb color{};
  for (std::size_t c = 0; c < color.size(); ++c) {
    const double mixed = (1 - part) * kHeatRamp[index][c] + part * kHeatRamp[index + 1][c];
    color[c] = static_cast<std::uint8_t>(std::lround(mixed));
  }
  return color;
}

double hottest_difference(const Tone& tone_b, double scale) {
  return 1 / (scale * static_cast<double>(tone_b.scale));
}

ByteImage heat_map(const LayerPair& layer, const PixelRect& data_window, double hottest) {
  const std::size_t pixels = layer.a.front()->pixels.size();
  ByteImage image{data_window.width(), data_window.height(), 3, {}};
  image.bytes.reserve(pixels * 3);
  for (std::size_t i = 0; i < pixels; ++i) {
    double difference = 0.0;
    for (std::size_t c = 0; c < layer.a.size(); ++c) {
      difference = larger_difference(difference, layer.a[c]->pixels[i], layer.b[c]->pixels[i]);
    }
    const Rgb color = std::isnan(difference) ? kNoNumberColor : heat_color(difference / hottest);
    image.bytes.insert(image.bytes.end(), color.begin(), color.end());
  }
  return image;
}

}  // namespace dapple
