// A ground under a place that is given, where add_ground(Scene&) takes the scene's own.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Adds an opaque square under `bounds`, 20 times as wide. Throws Error input where they are empty.
void add_ground(Scene& scene, const Box3f& bounds);

}  // namespace dapple
