#include "bvh/storage/textured_triangle.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dapple {
namespace {

/// Exponent of the smallest step, for coordinates in [0,1). Floats near 1 are only a little more
/// precise.
constexpr int kFinestExponent = -21;
static_assert(DAPPLE_UV_CODES == 1 << -kFinestExponent);

constexpr double kFarthest = 0x1p60;  // floats represent single tiles only far below this

using Coordinates = std::array<std::array<double, 2>, 3>;

double whole_tiles(double min, Wrap wrap) {
  if (wrap == Wrap::clamp) return 0;
  return wrap == Wrap::mirror ? 2 * std::floor(0.5 * min) : std::floor(min);
}

Coordinates without_whole_tiles(const TexturedCorners& corners, Wrap wrap_s, Wrap wrap_t) {
  Coordinates uv{};
  for (int axis = 0; axis < 2; ++axis) {
    for (int corner = 0; corner < 3; ++corner) {
      const double at = corners.uv[corner][axis];
      uv[corner][axis] = std::isnan(at) ? 0 : std::clamp(at, -kFarthest, kFarthest);
    }
    const double min = std::min({uv[0][axis], uv[1][axis], uv[2][axis]});
    const double tiles = whole_tiles(min, axis == 0 ? wrap_s : wrap_t);
    for (auto& corner : uv) corner[axis] -= tiles;
  }
  return uv;
}

/// The smallest steps whose codes span the coordinates of a triangle.
struct Steps {
  int exponent = kFinestExponent;
  double origin = 0;  ///< code of coordinate 0

  [[nodiscard]] double code(double coordinate) const {
    return std::round(std::ldexp(coordinate, -exponent)) + origin;
  }
};

Steps steps_for(const Coordinates& uv) {
  const auto [min, max] = std::minmax({uv[0][0], uv[0][1], uv[1][0], uv[1][1], uv[2][0], uv[2][1]});
  Steps steps;
  if (steps.code(min) < 0) steps.origin = 0.5 * DAPPLE_UV_CODES;
  while (steps.code(min) < 0 || steps.code(max) >= DAPPLE_UV_CODES) ++steps.exponent;
  return steps;
}

std::uint32_t alpha_code(float alpha) {
  const float inside = alpha > 0.0f ? std::min(alpha, 1.0f) : 0.0f;  // 0 for NaN
  return static_cast<std::uint32_t>(std::lround(inside * DAPPLE_ALPHA_ONE));
}

std::uint32_t step_and_flags(const Steps& steps, bool has_texture, bool has_vertex_alpha) {
  return static_cast<std::uint32_t>(steps.exponent + 63) |
         (steps.origin > 0 ? DAPPLE_UV_FROM_MIDDLE : 0u) | (has_texture ? DAPPLE_HAS_TEXTURE : 0u) |
         (has_vertex_alpha ? DAPPLE_HAS_VERTEX_ALPHA : 0u);
}

std::uint32_t texel_size_code(float size) {
  if (!(size > 0) || !std::isfinite(size)) return 0;
  const long code = std::lround(std::log2(size)) + DAPPLE_TEXEL_SIZE_BIAS;
  return code > 0 && code < DAPPLE_TEXEL_SIZE_CODES ? static_cast<std::uint32_t>(code) : 0;
}

}  // namespace

TexturedTriangle pack_textured(const TexturedCorners& corners, Wrap wrap_s, Wrap wrap_t) {
  assert(corners.material < DAPPLE_MAX_TEXTURED_MATERIALS);
  const Coordinates uv = without_whole_tiles(corners, wrap_s, wrap_t);
  const Steps steps = steps_for(uv);
  std::array<std::uint32_t, 3> alpha{};
  std::transform(corners.alpha.begin(), corners.alpha.end(), alpha.begin(), alpha_code);
  const bool has_vertex_alpha =
      alpha != std::array<std::uint32_t, 3>{DAPPLE_ALPHA_ONE, DAPPLE_ALPHA_ONE, DAPPLE_ALPHA_ONE};
  const std::uint32_t lowest_bits[3] = {
      corners.material & 1023u, corners.material >> 10 | texel_size_code(corners.texel_size) << 5,
      step_and_flags(steps, corners.has_texture, has_vertex_alpha)};
  TexturedTriangle triangle{};
  for (int corner = 0; corner < 3; ++corner) {
    const auto u = static_cast<std::uint32_t>(steps.code(uv[corner][0]));
    const auto v = static_cast<std::uint32_t>(steps.code(uv[corner][1]));
    triangle.corner[corner][0] = u << 11 | alpha[corner] >> 1;
    triangle.corner[corner][1] = v << 11 | (alpha[corner] & 1u) << 10 | lowest_bits[corner];
  }
  return triangle;
}

void set_texel_size(TexturedTriangle& triangle, float size) {
  uint& word = triangle.corner[1][1];
  if (DAPPLE_TEXEL_SIZE_CODE(word) == 0) return;
  constexpr uint kLargest = DAPPLE_TEXEL_SIZE_CODES - 1;
  const uint code =
      size >= 1.0f && texel_size_code(size) == 0 ? kLargest : std::max(texel_size_code(size), 1u);
  word = (word & ~(kLargest << 5)) | code << 5;
}

TexturedCorners unpack_textured(const TexturedTriangle& triangle) {
  TexturedCorners corners;
  const uint last = triangle.corner[2][1];
  const float step = dapple_bits_to_float(DAPPLE_UV_STEP_BITS(last));
  const auto coordinate = [&](uint word) {
    const auto from_origin = static_cast<int>(DAPPLE_UV_CODE(word) - DAPPLE_UV_ORIGIN(last));
    return step * static_cast<float>(from_origin);
  };
  for (uint corner = 0; corner < 3; ++corner) {
    const auto& [first, second] = triangle.corner[corner];
    corners.uv[corner] = V2f(coordinate(first), coordinate(second));
    corners.alpha[corner] =
        static_cast<float>(DAPPLE_VERTEX_ALPHA(first, second)) * (1.0f / DAPPLE_ALPHA_ONE);
  }
  corners.material = textured_material(&triangle);
  corners.has_texture = has_texture(&triangle) != 0;
  const uint size = DAPPLE_TEXEL_SIZE_CODE(triangle.corner[1][1]);
  if (size) corners.texel_size = std::ldexp(1.0f, static_cast<int>(size) - DAPPLE_TEXEL_SIZE_BIAS);
  return corners;
}

}  // namespace dapple
