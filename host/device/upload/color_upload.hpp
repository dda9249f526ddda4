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

}  // namespace dapple
