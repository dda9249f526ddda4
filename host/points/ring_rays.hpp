// Rays from points into zenith rings. In: a point and a ring. Out: rays.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/ray.h"

namespace dapple {

/// Directions between two cosines of the angle from +Y.
struct ZenithRing {
  double cos_inner = 1, cos_outer = 0;
};

/// `count` rings: for 5 those of the LAI-2200, else of equal width from 0 to 90 degrees.
std::vector<ZenithRing> zenith_rings(int count);

/// A ray without an end from a point, off it along `normal` by more than rounding errors.
Ray point_ray(const V3f& point, const V3f& normal, const V3f& direction, float solid_angle);

/// Appends `count` rays, uniform by solid angle within a ring: a Vogel spiral, turned at random.
void append_ring_rays(const V3f& point, const ZenithRing& ring, int count, std::uint32_t seed,
                      std::uint32_t index, std::vector<Ray>& rays);

}  // namespace dapple
