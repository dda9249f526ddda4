// Adds a ground under given bounds. In: a scene and a box; out: the same scene with one mesh,
// instance and material more. add_ground(Scene&) in dapple/scene.hpp uses the scene's own bounds.
#pragma once

#include <optional>

#include "dapple/scene.hpp"

namespace dapple {

/// scene_bounds() down to the lowest vertex: those of tilted instances of one mesh reach below it.
/// Of scenes that need more than 2^27 vertices for that, to the lowest of some and the others'
/// boxes. Throws as scene_bounds().
Box3f bounds_to_stand_on(const Scene& scene);

/// The y of a ground under `bounds`: lower than these by 1e-5 of their longest side, since a floor
/// of the scene's own may be as low.
float ground_height(const Box3f& bounds);

/// Adds an opaque square under `bounds`, 200 times as wide, at y = `height`; none: at their
/// ground_height(). Throws Error input when they are empty.
void add_ground(Scene& scene, const Box3f& bounds, std::optional<float> height = {});

}  // namespace dapple
