// A scene that repeats itself in the plane, as copies of its instances. In and out: a scene.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Adds copies of all instances at multiples of the periods, so far that rays from between them
/// leave the scene's height before they leave the copies, but for those within five degrees of the
/// horizon. Throws Error usage if that takes too many copies.
void repeat(Scene& scene, float period_x, float period_z);

}  // namespace dapple
