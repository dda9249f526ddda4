// Mip levels of colour textures. In: a texture, and how much its texels count. Out: means, linear.
#pragma once

#include <array>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// One level of a colour texture, row by row, linear.
struct ColorLevel {
  std::uint32_t width = 0, height = 0;
  std::vector<V3f> color;
};

/// What the codes of 8 bits stand for: the sRGB transfer function of IEC 61966-2-1.
const std::array<float, 256>& linear_of_codes();

/// How much texels count in means, by their alphas: as much as they are seen.
struct TexelWeights {
  static constexpr int kEqual = -1, kByAlpha = -2;
  int least =
      kEqual;  ///< or the least alpha of 8 bits that is seen, of those that hide all or nothing

  bool operator<(const TexelWeights& other) const { return least < other.least; }
};

/// Equal where a material ignores alphas, 0 or 1 for masks, else by alpha.
TexelWeights texel_weights(const Material& material);

/// The levels above the texture itself. Level k is half as wide and high as level k - 1, rounded
/// down, and at least 1. Unseen texels of a cut-out do not colour the others; where none is seen
/// all count the same.
std::vector<ColorLevel> color_mip_levels(const ColorTexture& texture, const TexelWeights& weights);

}  // namespace dapple
