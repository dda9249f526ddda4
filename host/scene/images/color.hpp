// Linear RGB with the primaries of ITU-R BT.709, and its encoding for displays. In: numbers; out:
// numbers.
#pragma once

#include <Imath/ImathVec.h>

#include <cmath>

namespace dapple {

inline double luminance(const Imath::V3d& rgb) {
  return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}
inline double luminance(const Imath::V3f& rgb) { return luminance(Imath::V3d(rgb)); }

/// The sRGB transfer function of IEC 61966-2-1, for values in [0,1], and its inverse.
inline float srgb_from_linear(float value) {
  return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1 / 2.4f) - 0.055f;
}
inline double linear_from_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

}  // namespace dapple
