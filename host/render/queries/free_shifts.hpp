// Points of smooth surfaces close to other surfaces. In: a scene and points. Out: where their rays
// may start.
#pragma once

#include <vector>

#include "render/queries/shared_points.hpp"

namespace dapple {

/// QueryPoints::shifts, but zero where a surface lies between a point and the smooth surface that
/// it would move to: rays from there would not meet it, and a leaf that lies on a trunk would not
/// darken it. One exact ray for each point that moves. Empty if the points have no shifts.
std::vector<V3f> free_shifts(const Device& device, const DeviceScene& scene,
                             const QueryPoints& points);

}  // namespace dapple
