// Bounds of scenes that were checked. scene_bounds() of dapple/scene.hpp checks them first.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// As scene_bounds(), of a scene for which check_geometry() has passed.
Box3f checked_bounds(const Scene& scene, const M44f& transform = {});

}  // namespace dapple
