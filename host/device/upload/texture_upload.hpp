// Materials of textured triangles and their textures, as kernels/opacity/opacity_lookup.clh reads them.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/geometry.h"

namespace dapple {

/// One record a material, in the scene's order, and the texels that they point to: each texture
/// once, and once for each way in which its coarser levels are averaged.
void pack_materials(const Scene& scene, std::vector<MaterialRecord>& records,
                    std::vector<uchar>& texels);

}  // namespace dapple
