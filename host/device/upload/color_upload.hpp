// Colours of surfaces for the shading pass. In: a scene and its BVH. Out: the words, materials and
// texels of include/dapple/shared/surface_color.h.
#pragma once

#include <vector>

#include "dapple/bvh.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/surface_color.h"
#include "files/checksum.hpp"

namespace dapple {

struct SurfaceColors {
  std::vector<uint> words;               ///< of surfaces
  std::vector<ColorMaterial> materials;  ///< as many as in the scene
  std::vector<uint> texels;              ///< textures and their mip levels
};

/// A checksum of all that colours depend on besides the BVH.
Checksum color_key(const Scene& scene);

/// SurfaceColors::words. They hold sizes of texels, so they change when vertices move.
std::vector<uint> pack_color_words(const Scene& scene, const SceneBvh& bvh);

/// Throws Error failed if there are more words or texels than indices can represent.
SurfaceColors pack_colors(const Scene& scene, const SceneBvh& bvh);

/// One level of a colour texture, row by row, linear.
struct ColorLevel {
  std::uint32_t width = 0, height = 0;
  std::vector<V3f> color;
};

/// The levels above the texture itself. Level k is half as wide and high as level k - 1, rounded
/// down, and at least 1. Texels are averaged by their alphas, so that the unseen ones of a cut-out
/// do not colour the others; where all alphas are 0 they count the same.
std::vector<ColorLevel> color_mip_levels(const ColorTexture& texture);

}  // namespace dapple
