// What queries at points demand of the caller's points. In: points and normals. Out: nothing, or an
// error.
#pragma once

#include <span>

#include "dapple/scene.hpp"

namespace dapple {

/// Throws Error usage, which begins with the name of the query, if sizes differ, a point is not
/// finite, or a normal is not a unit vector.
void check_points(const char* query, std::span<const V3f> points, std::span<const V3f> normals);

}  // namespace dapple
