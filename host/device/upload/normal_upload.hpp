// Normals of the corners of triangles, as the shading pass reads them. In: a scene and its BVH.
// Out: the array of dapple/shared/corner_normals.h: 8 bytes for each lane of the blocks that hold
// smooth triangles, and 4 bytes for each block.
#pragma once

#include <array>
#include <vector>

#include "dapple/bvh.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/corner_normals.h"

namespace dapple {

/// Packs three normals, which need not be unit vectors. The angle between a normal and its code is
/// at most 0.17 degrees.
CornerNormals pack_corner_normals(const std::array<V3f, 3>& normals);

/// The corner_normals() of all triangles. Returns nothing if all are flat, unless `keep_flat`.
std::vector<CornerNormals> pack_normals(const Scene& scene, const SceneBvh& bvh,
                                        bool keep_flat = false);

}  // namespace dapple
