// Bakes the texels of a texture that all meshes of a scene share. In: a scene with its layout and a
// tracer. Out: AO and bent normals of all texels.
#pragma once

#include "bake/bake_progress.hpp"
#include "bake/sample_tracer.hpp"

namespace dapple {

class TextureBake {
 public:
  TextureBake(const Scene& scene, const BakeOptions& options, TextureLayout layout);

  [[nodiscard]] const TextureLayout& layout() const { return texture_.layout; }

  /// The values of mesh number `index`. False: stopped.
  bool add(std::uint32_t index, const Placements& placements, SampleTracer& tracer,
           BakeProgress& progress, BakeStatistics& statistics);

  /// The texture, with its margin.
  BakedTexture finish();

 private:
  const Scene& scene_;
  const BakeOptions& options_;
  BakedTexture texture_;
  std::vector<bool> known_, covered_;  ///< by texel
  std::vector<float> weight_;          ///< part of each texel that triangles cover
};

}  // namespace dapple
