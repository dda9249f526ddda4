// How much of a texture several triangles share, and whether they are of one mesh. In: texture
// coordinates. Out: shares of the covered texels. See uv_overlap() in dapple/bake.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/bake.hpp"

namespace dapple {

/// Shares of the covered texels, [0,1].
struct UvOverlap {
  double share = 0;   ///< all that uv_overlap() counts; infinity if coordinates leave the texture
  double within = 0;  ///< several triangles of one mesh
  double among = 0;   ///< triangles of several meshes
};

/// For coordinates as BakeOptions::texture_uvs, of the meshes that a bake with `placement` bakes.
UvOverlap find_overlap(const Scene& scene, const std::vector<std::vector<V2f>>& uvs,
                       std::uint32_t size, BakePlacement placement);

/// For corners as TextureLayout::corners.
UvOverlap find_overlap(const std::vector<std::vector<V2f>>& corners, std::uint32_t size);

}  // namespace dapple
