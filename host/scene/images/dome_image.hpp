// Arithmetic of latitude-longitude images: texels, solid angles. In: an Environment
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
