#include "files/exr_color_space.hpp"

#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <exception>
#include <limits>

namespace dapple {
namespace {

using Imath::M33f;
using Imath::V3f;

/// Columns of the matrix from X, Y, Z to responses of cones, by the Bradford method.
const M33f kCones(0.8951f, -0.7502f, 0.0389f, 0.2664f, 1.7135f, -0.0685f, -0.1614f, 0.0367f,
                  1.0296f);

M33f upper_left(const Imath::M44f& m) {
  return {m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]};
}

V3f white_of(const Imf::Chromaticities& c) {
  return {c.white.x / c.white.y, 1, (1 - c.white.x - c.white.y) / c.white.y};
}

M33f adaptation(const V3f& from, const V3f& to) {
  const V3f cones = from * kCones, wanted = to * kCones;
  M33f scale;
  for (int i = 0; i < 3; ++i) scale[i][i] = wanted[i] / cones[i];
  return kCones * scale * kCones.inverse();
}

}  // namespace

M33f to_bt709(const Imf::Header& header) {
  const Imf::Chromaticities bt709;
  if (!Imf::hasChromaticities(header)) return {};
  const Imf::Chromaticities& of_file = Imf::chromaticities(header);
  if (of_file == bt709) return {};
  try {
    return upper_left(Imf::RGBtoXYZ(of_file, 1)) * adaptation(white_of(of_file), white_of(bt709)) *
           upper_left(Imf::XYZtoRGB(bt709, 1));
  } catch (const std::exception&) {  // OpenEXR's, of primaries on a line
    return M33f(std::numeric_limits<float>::quiet_NaN());
  }
}

bool is_cube_map(const Imf::Header& header) {
  return Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE;
}

}  // namespace dapple
