// What opacity a triangle has: one number, or a texture and factors to be looked up at
// each hit (kernels/opacity_lookup.clh) and averaged over areas when prefiltering.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "bvh/textured_triangle.hpp"
#include "dapple/scene.hpp"

namespace dapple {

/// The triangle's opacity in [0,1] if it is the same all over, else nothing.
std::optional<float> uniform_opacity(const Scene& scene, const Mesh& mesh, std::uint32_t triangle);

/// Of a segment of a strand, [0,1]: its ends' mean alpha, by the material. No textures.
float segment_opacity(const Scene& scene, const Mesh& mesh, std::uint32_t segment);

/// Whether alpha is looked up.
bool has_texture(const Material& material, const Mesh& mesh);

/// The opacity of an alpha, `cutoff` as cutoff_of().
float thresholded(float alpha, float cutoff);

/// The alpha from which on a masked material is opaque, or -1 where alpha is opacity.
float cutoff_of(const Material& material);

/// The record the kernels look a varying triangle up by. Throws Error failed where its material
/// is beyond the most that the records can name.
TexturedTriangle textured_triangle(const Scene& scene, const Mesh& mesh, std::uint32_t triangle);

/// A texture's opacities averaged over squares of 1, 2, 4... texels. Of a cut-out the
/// texels are thresholded first and averaged only then.
class OpacityPyramid {
 public:
  /// `factor` multiplies alpha before the threshold; `cutoff` < 0: blended.
  OpacityPyramid(const Texture& texture, float factor, float cutoff);

  /// Mean opacity around uv over a square `width_uv` wide (in units of the whole texture,
  /// the larger of both axes' in texels counts).
  [[nodiscard]] float mean(V2f uv, float width_texels) const;

  [[nodiscard]] V2f size() const { return size_; }

 private:
  struct Level {
    int width, height;
    std::vector<float> opacity;
  };
  [[nodiscard]] float bilinear(const Level& level, V2f uv) const;

  std::vector<Level> levels_;
  V2f size_;
  Wrap wrap_s_, wrap_t_;
};

/// Answers "how opaque is this part of the triangle on average" for textured triangles.
class TextureIntegrals {
 public:
  /// Makes the pyramids that `textured` need, each once. Keeps `scene`'s materials by address.
  TextureIntegrals(const Scene& scene, std::span<const TexturedTriangle> textured);

  /// Mean opacity of the triangle around barycentrics (u, v) over an area that is `share`
  /// of the triangle's, [0,1].
  [[nodiscard]] float mean(const TexturedTriangle& triangle, float u, float v, float share) const;

 private:
  struct Key {
    int texture;
    float factor, cutoff;
    auto operator<=>(const Key&) const = default;
  };
  [[nodiscard]] Key key_of(const TexturedCorners& corners) const;
  [[nodiscard]] const OpacityPyramid* find(const Key& key) const;

  const std::vector<Material>& materials_;
  std::vector<std::pair<Key, OpacityPyramid>> pyramids_;  ///< sorted by key
};

}  // namespace dapple
