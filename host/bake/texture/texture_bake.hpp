// Bakes the texels of a texture that all meshes of a scene share. In: a scene, the layout of its
// texture, and functions that trace samples. Out: AO, bent normals and irradiance of all texels.
#pragma once

#include "bake/samples/sample_rounds.hpp"
#include "bake/two_sided.hpp"

namespace dapple {

class SampledTexels;

class TextureBake {
 public:
  TextureBake(const Scene& scene, const BakeOptions& options, TextureLayout layout);

  [[nodiscard]] const TextureLayout& layout() const { return texture_.layout; }

  /// The values of mesh number `index`, if the texture has it. False: stopped.
  bool add(std::uint32_t index, const Placements& placements, BakeTracing& tracing);

  /// The texture, with its margin.
  BakedTexture finish(BakeStatistics& statistics);

 private:
  /// Texels without a value take that of the one that `nearest` names: those that triangles cover,
  /// or the others.
  void take_nearest(const std::vector<std::uint32_t>& nearest, bool covered);
  /// Texels inside closed geometry take the nearest value of their charts. Charts that lie inside
  /// as a whole are never seen, and stay black.
  void fill_enclosed_texels(BakeStatistics& statistics);
  void clear_beyond_margin();
  void join_all_seams();
  void add_values(const SampledTexels& texels, const std::vector<PlaceValue>& values,
                  const std::vector<std::vector<V3f>>& light, BakeStatistics& statistics);

  const Scene& scene_;
  const BakeOptions& options_;
  const TwoSided two_sided_;
  BakedTexture texture_;
  std::vector<bool> known_, covered_;  ///< by texel
  std::vector<float> weight_;          ///< part of each texel that triangles cover
};

}  // namespace dapple
