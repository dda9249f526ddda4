// Checks that a mesh does not have thousands of instances with the same matrix: every ray there
// would intersect all of them, and no sensible scene has them. In: a scene; out: an error.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::gltf {

/// Throws Error input when one mesh has more than 1,000 instances with the same matrix.
void check_crowding(const Scene& scene);

}  // namespace dapple::gltf
