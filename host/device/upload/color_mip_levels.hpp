// Mip levels of colour textures. In: a texture, and how much its texels count. Out: means, linear.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
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
  enum class Kind : std::uint8_t { equal, by_alpha, cut_out };
  Kind kind = Kind::equal;
  int least_seen = 0;  ///< of cut-outs the least alpha of 8 bits that is seen; 256: none is

  auto operator<=>(const TexelWeights&) const = default;
};

/// Equal where a material ignores alphas, by alpha where it blends, cut out where it masks.
TexelWeights texel_weights(const Material& material);

/// The levels above the texture itself. Level k is half as wide and high as level k - 1, rounded
/// down, and at least 1. Texels that are not seen do not colour the others, and get the colour of
/// what is seen around them, since lookups between texels read them, too (push-pull: Gortler et
/// al., "The Lumigraph", 1996). Where none is seen all count the same.
std::vector<ColorLevel> color_mip_levels(const ColorTexture& texture, const TexelWeights& weights);

/// `weights`, or equal ones if no texel of the texture would be seen.
TexelWeights weights_of_seen(const ColorTexture& texture, const TexelWeights& weights);

/// Whether a texel counts at all.
bool is_seen(const ColorTexture& texture, const TexelWeights& weights, std::size_t texel);

/// The colour for the texel of the texture in column x and row y, which does not count. `coarser`:
/// the first of its levels.
V3f color_of_unseen(const ColorTexture& texture, const TexelWeights& weights,
                    const ColorLevel& coarser, std::uint32_t x, std::uint32_t y);

}  // namespace dapple
