// Skies as dome lights: luminance by zenith angle in, a light out.
#include <cmath>
#include <numbers>

#include "dapple/scene.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kRows = 512;  ///< from the zenith to the nadir

template <class Luminance>
Light sky(const std::string& name, Luminance luminance) {
  using std::numbers::pi;
  auto image = std::make_shared<Environment>();
  image->width = 1;
  image->height = kRows;
  double horizontal = 0;
  for (std::uint32_t row = 0; row < kRows; ++row) {
    const double top = std::cos(pi * row / kRows), bottom = std::cos(pi * (row + 1) / kRows);
    const double value = row < kRows / 2 ? luminance(0.5 * (top + bottom)) : 0.0;
    if (row < kRows / 2) horizontal += value * pi * (top * top - bottom * bottom);
    image->radiance.push_back(V3f(static_cast<float>(value)));
  }
  Light light;
  light.name = name;
  light.kind = LightKind::dome;
  light.radiance = V3f(static_cast<float>(1 / horizontal));
  light.environment = image;
  return light;
}

}  // namespace

Light overcast_sky() {
  return sky("sky", [](double cosine) { return (1 + 2 * cosine) / 3; });
}

Light uniform_sky() {
  return sky("sky", [](double) { return 1.0; });
}

}  // namespace dapple
