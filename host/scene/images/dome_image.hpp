// Arithmetic of latitude-longitude images: texels, luminance, solid angles. In: an Environment
// (dapple/scene.hpp) and texel numbers; out: numbers.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "dapple/scene.hpp"

namespace dapple {

inline const V3f& texel(const Environment& environment, std::uint32_t x, std::uint32_t y) {
  return environment.radiance[std::size_t{y} * environment.width + x];
}

/// The luminance of linear RGB with the primaries of ITU-R BT.709.
inline double luminance(const V3d& rgb) { return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z; }
inline double luminance(const V3f& rgb) { return luminance(V3d(rgb)); }

/// The solid angle of one texel of row `y`, in steradians.
inline double texel_solid_angle(std::uint32_t width, std::uint32_t height, std::uint32_t y) {
  using std::numbers::pi;
  const auto rows = static_cast<double>(height);
  return 2 * pi / width * (std::cos(pi * y / rows) - std::cos(pi * (y + 1) / rows));
}
inline double texel_solid_angle(const Environment& environment, std::uint32_t y) {
  return texel_solid_angle(environment.width, environment.height, y);
}

}  // namespace dapple
