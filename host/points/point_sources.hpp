// Points that no file has: on a grid, or on a scene's triangles.
#pragma once

#include <array>

#include "points/point_file.hpp"

namespace dapple {

/// Points from (x0, z0) to (x1, z1) with a step, at a height, facing up. `corners`: x0, z0, x1, z1,
/// step. Throws Error usage if there are none, or more than 10^8.
PointList grid_points(const std::array<double, 5>& corners, double height);

/// For each instance and triangle its centre, first with the front side's normal, then the back's.
/// Triangles without an area are ignored. Extra columns: `instance` and `material`, numbers from 0
/// in the scene; `side`, 1 for the front and -1 for the back; `area` of the triangle, m^2.
PointList triangle_points(const Scene& scene);

}  // namespace dapple
