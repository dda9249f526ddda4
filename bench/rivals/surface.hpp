// Where a hit of Embree's lies, made from the triangle itself: more exact than the ray's end.
#pragma once

#include "rivals/embree_geometry.hpp"
#include "rivals/ray_batch.hpp"

namespace dapple::bench {

struct Surface {
  V3f position;  ///< world space
  V3f normal;    ///< geometric, unit, turned against the ray
};

/// Of hit `i`, which must have met something, of `rays`.
Surface surface_of(const EmbreeGeometry& geometry, const RayBatch& rays, const HitBatch& hits,
                   unsigned i);

/// Where rays from a surface start: off it along the normal by `roundings` of the largest
/// coordinate, which are 2^-24 each.
V3f ray_start(const Surface& surface, float roundings);

}  // namespace dapple::bench
