// Removes from a scene what no ray can hit: broken triangles and segments, and meshes and mesh
// lights without an instance. In and out: a scene; its warnings say what was removed.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Drops triangles with non-finite vertices or without an area, and segments of strands with
/// non-finite ends, without a length or without a radius, from every mesh that has an instance.
/// In a mesh that loses one, also drops the vertices that nothing uses. Adds a warning for each
/// kind, with the count.
void drop_unhittable_triangles(Scene& scene);

/// Drops instances of empty meshes, meshes without an instance, and mesh lights without an
/// instance (with a warning). Renumbers the remaining meshes and lights.
void drop_unused(Scene& scene);

}  // namespace dapple
