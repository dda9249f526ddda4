// Materials of textured triangles and their textures, as kernels/opacity/opacity_lookup.clh reads
// them. In: a scene. Out: records of materials, and bytes of all mip levels (Williams, "Pyramidal
// Parametrics", 1983).
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/geometry.h"

namespace dapple {

/// Flags of records of textures.
uint texture_flags(Wrap s, Wrap t, bool nearest);

/// Appends one record for each material, in the scene's order, and the texels that the records
/// refer to: each texture once, and its coarser mip levels once for each alpha factor and cutoff
/// that the materials average them with.
void pack_materials(const Scene& scene, std::vector<MaterialRecord>& records,
                    std::vector<uchar>& texels);

}  // namespace dapple
