// Adds a ground under given bounds. In: a scene and a box; out: the same scene with one mesh,
// instance and material more. add_ground(Scene&) in dapple/scene.hpp uses the scene's own bounds.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Adds an opaque square under `bounds`, 200 times as wide, lower by 1e-5 of their longest side.
/// Throws Error input when they are empty.
void add_ground(Scene& scene, const Box3f& bounds);

}  // namespace dapple
