// The range of numbers that dapple renders. Float holds up to 1e38, but an area is a product of
// lengths and a solid angle is a quotient of areas: intermediate results must stay in range too.
// In: a scene; out: an error when it is out of range.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

inline constexpr double kLargestCoordinate = 1e12;  // metres, absolute value
inline constexpr double kSmallestLength = 1e-9;     // metres, of a light; also a strand's radius
inline constexpr double kLargestRadiance = 1e30;    // W/(sr m^2)

/// Throws Error input when a coordinate of the geometry, of a rect, disk or sphere light's position
/// or of a camera's position is beyond kLargestCoordinate; the message names the object. Adds a
/// warning where the scene is so far from the origin that floats have coarse steps there. Vertices
/// that are not finite must have been removed before.
void check_numeric_range(Scene& scene);

}  // namespace dapple
