// Mip levels of a texture's opacity, for prefiltering nodes and for rays whose footprints cover
// many texels (kernels/opacity/opacity_lookup.clh).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Returns the opacity of `alpha`: 1 from `cutoff` on and 0 below it. If `cutoff` < 0, returns the
/// alpha itself, clamped to [0,1].
float thresholded(float alpha, float cutoff);

/// Whether texture coordinates lie beyond [0,1] of an axis on which the texture is clamped. What
/// they see there is its border, which coarser texels mix with what is inside.
bool is_beyond_border(const std::array<V2f, 3>& uvs, Wrap wrap_s, Wrap wrap_t);

/// The opacities of a texture, averaged over 1, 2, 4... texels along each axis (Williams,
/// "Pyramidal Parametrics", 1983). Cut-out textures are thresholded before they are averaged:
/// texels of those that are looked up bilinearly have the share of their square that is then
/// opaque.
class OpacityMipLevels {
 public:
  /// Level k is half as wide and high as level k - 1, rounded down, and at least 1.
  struct Level {
    int width, height;
    std::vector<float> opacity;  ///< row by row, [0,1]
  };

  /// `factor` multiplies alpha before the threshold; `cutoff` < 0: blended.
  OpacityMipLevels(const Texture& texture, float factor, float cutoff);

  /// Mean opacity around uv over a square `width_texels` wide.
  [[nodiscard]] float mean(V2f uv, float width_texels) const;

  /// All levels, from the texture itself to a single texel.
  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }

  [[nodiscard]] V2f size() const { return size_; }

  [[nodiscard]] bool is_beyond_border(const std::array<V2f, 3>& uvs) const {
    return dapple::is_beyond_border(uvs, wrap_s_, wrap_t_);
  }

 private:
  [[nodiscard]] float bilinear(const Level& level, V2f uv) const;

  std::vector<Level> levels_;
  V2f size_;
  Wrap wrap_s_, wrap_t_;
};

/// Returns the number of texels of all levels, including the texture itself.
std::size_t mip_level_texels(std::size_t width, std::size_t height);

}  // namespace dapple
