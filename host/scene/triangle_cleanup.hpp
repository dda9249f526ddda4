// Takes out of a scene what no ray can hit: broken triangles, and meshes and mesh lights that
// nothing places. In and out: a scene; its warnings say how much went.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Drops triangles with non-finite vertices, triangles without an area, and the vertices that
/// only they used, from every mesh that is placed. Adds a warning for each kind, with the count.
void drop_unhittable_triangles(Scene& scene);

/// Drops placements of empty meshes, meshes that nothing places, and mesh lights without a
/// placement (with a warning); renumbers the rest.
void drop_unused(Scene& scene);

}  // namespace dapple
