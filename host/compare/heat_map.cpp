#include "compare/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// A kNoNumber in `so_far` stays, since std::max(NaN, x) is NaN in this order of arguments.
double larger_difference(double so_far, float a, float b) {
  if (a == b) return so_far;  // infinities included
  if (!std::isfinite(a) || !std::isfinite(b)) return kNoNumber;
  return std::max(so_far, std::abs(static_cast<double>(a) - static_cast<double>(b)));
}

}  // namespace

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
