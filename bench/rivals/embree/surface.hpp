// Position and normal of a hit of Embree. In: a batch of rays and hits. Out: the point, computed
// from the primitive, which is more accurate than origin + t * direction.
#pragma once

#include "rivals/embree/embree_geometry.hpp"
#include "rivals/embree/ray_batch.hpp"

namespace dapple::bench {

struct Surface {
  V3f position;  ///< world space
  V3f normal;    ///< geometric, unit, on the side of the ray's origin
};

/// The surface of hit `i`, which must not be a miss.
Surface surface_of(const EmbreeGeometry& geometry, const RayBatch& rays, const HitBatch& hits,
                   unsigned i);

/// Origin of rays from a surface: offset along the normal by `roundings` times 2^-24 of the largest
/// coordinate.
V3f ray_start(const Surface& surface, float roundings);

}  // namespace dapple::bench
