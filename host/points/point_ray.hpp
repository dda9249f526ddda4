// Rays from points to directions that the host chooses. In: a point, its normal and a direction.
// Out: a ray.
#pragma once

#include <cstdint>

#include "dapple/scene.hpp"
#include "dapple/shared/ray.h"

namespace dapple {

/// A ray without an end from a point, off it along `normal` by more than rounding errors. `key`:
/// random bits, which scale its footprint.
Ray point_ray(const V3f& point, const V3f& normal, const V3f& direction, float solid_angle,
              std::uint32_t key);

}  // namespace dapple
