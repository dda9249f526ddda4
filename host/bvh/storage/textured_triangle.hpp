// Textured triangles packed for the kernels, and the one accessor that unpacks them on the host;
// kernels/opacity/opacity_lookup.clh decodes the same bits
// (include/dapple/shared/textured_triangle.h).
#pragma once

#include <array>
#include <cstdint>

#include "dapple/scene.hpp"
#include "dapple/shared/textured_triangle.h"

namespace dapple {

struct TexturedCorners {
  std::array<V2f, 3> uv{V2f(0.0f), V2f(0.0f), V2f(0.0f)};
  std::array<float, 3> alpha{1, 1, 1};  ///< COLOR_0.a, without the material's factor, [0,1]
  std::uint32_t material = 0;           ///< index into Scene::materials
  bool has_texture = false;             ///< else `uv` means nothing
  /// How wide a texel is on the triangle, in the object's units; 0: not known.
  float texel_size = 0;
};

/// Whole tiles are taken off, where a wrap mode repeats, so that the least u and v lie in the
/// first one (of two, where it mirrors). Coordinates are then rounded to half of 2^-21 where all
/// six are in [0,1), of 2^-20 in [0,2) and so on, twice that where one is negative; alphas to half
/// of 1/4080, and 0, 1 and 8-bit colours not at all; sizes of texels to powers of two, and beyond
/// [2^-24, 2^6] to not known. What is not a number becomes 0, beyond 2^60
/// that. `corners.material` is below DAPPLE_MAX_TEXTURED_MATERIALS.
TexturedTriangle pack_textured(const TexturedCorners& corners, Wrap wrap_s, Wrap wrap_t);

TexturedCorners unpack_textured(const TexturedTriangle& triangle);

}  // namespace dapple
