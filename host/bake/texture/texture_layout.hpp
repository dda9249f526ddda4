// Where the triangles of a scene lie in one texture. In: meshes, or texture coordinates of a file.
// Out: texture coordinates of the corners of all triangles.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dapple/bake.hpp"

namespace dapple {

/// Whether each mesh is in the texture: no strands, none without a placement, and of meshes that
/// are one mesh of a file in several poses only the first one.
std::vector<bool> textured_meshes(const Scene& scene, BakePlacement kind);

/// The point of the texture that coordinates name: the border where they are rounding errors, 1e-5
/// at most, outside of [0,1]; none if they are farther outside.
std::optional<V2f> texture_point(const V2f& uv);

/// Makes a layout of its own for all textured meshes: make_charts() of each, packed by size. Throws
/// Error usage, with the size that it takes, if they don't fit in options.texture_size.
TextureLayout make_layout(const Scene& scene, const BakeOptions& options);

/// The layout that options.texture_uvs give.
TextureLayout given_layout(const Scene& scene, const BakeOptions& options);

/// The share of the surface of placed meshes, each as large as at its first placement, whose
/// triangles have no area in a `size` x `size` texture, [0,1]; for texture coordinates as
/// BakeOptions::texture_uvs. Values of such triangles cannot be stored.
double share_without_texels(const Scene& scene, const std::vector<std::vector<V2f>>& uvs,
                            std::uint32_t size, BakePlacement placement);

}  // namespace dapple
