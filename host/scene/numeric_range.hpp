// The numbers that can be rendered: float holds 1e38, but areas are products of lengths, solid
// angles quotients of areas, and what leaves its range on the way is no number any more.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

inline constexpr double kLargestCoordinate = 1e12;  // metres, either way
inline constexpr double kSmallestLength = 1e-9;     // metres, of a light
inline constexpr double kLargestRadiance = 1e30;    // W/(sr m^2)

/// Throws Error input, naming what it is, when geometry, a light or a camera of `scene` is
/// beyond these. Coordinates that are not finite must be gone.
void check_numeric_range(const Scene& scene);

}  // namespace dapple
