// Sizes of texels on the triangles of an object whose vertices moved. In: the moved mesh, the
// object's blocks. Out: records of textured triangles with these sizes.
#pragma once

#include <cstdint>
#include <span>

#include "dapple/scene.hpp"
#include "dapple/shared/geometry.h"
#include "dapple/shared/textured_triangle.h"

namespace dapple {

/// Sets the sizes in `textured`, the records that `blocks` refer to. `primitives`: the triangle of
/// each lane. Sizes that are not known stay so. Returns whether any record changed.
bool set_texel_sizes(const Scene& scene, const Mesh& mesh, std::span<const TriangleBlock> blocks,
                     std::span<const std::uint32_t> primitives,
                     std::span<TexturedTriangle> textured);

}  // namespace dapple
