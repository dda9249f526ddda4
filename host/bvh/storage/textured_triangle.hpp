// Packs textured triangles for the kernels, and unpacks them on the host. In: coordinates and
// alphas of the corners. Out: the bits of include/dapple/shared/textured_triangle.h, which
// kernels/opacity/opacity_lookup.clh decodes.
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
  bool has_texture = false;             ///< if false, `uv` has no meaning
  /// Width of a texel on the triangle, in units of the object; 0: not known.
  float texel_size = 0;
};

/// Packs a triangle. First, if a wrap mode repeats, whole tiles are subtracted so that the minimum
/// u or v lies in the first tile (in the first two if it mirrors). Then the values are rounded:
/// coordinates with an error of at most half of 2^-21 if all six are in [0,1), of 2^-20 in [0,2)
/// and so on, and twice that if one is negative; alphas with an error of at most half of 1/4080,
/// while 0, 1 and 8-bit colours are exact; sizes of texels to powers of two, and to not known
/// outside [2^-24, 2^6]. Coordinates that are NaN become 0; those beyond 2^60 become 2^60.
/// `corners.material` must be below DAPPLE_MAX_TEXTURED_MATERIALS.
TexturedTriangle pack_textured(const TexturedCorners& corners, Wrap wrap_s, Wrap wrap_t);

/// Changes TexturedCorners::texel_size of a packed triangle, unless it is not known. Here sizes
/// outside the range become the nearest that can be stored.
void set_texel_size(TexturedTriangle& triangle, float size);

TexturedCorners unpack_textured(const TexturedTriangle& triangle);

}  // namespace dapple
