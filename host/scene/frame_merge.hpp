// Merges the meshes of a frame. In: a scene as it was read. Out: the same scene with fewer meshes.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// merge_single_instances(), but where an animation has scaled everything to nothing the scene gets
/// a triangle too small to be hit, and a warning.
void merge_frame(Scene& scene);

}  // namespace dapple
