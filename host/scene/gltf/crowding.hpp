// Instances in one place, which no scene has by the thousand: every ray there would meet all
// of them.
#pragma once

#include "dapple/scene.hpp"

namespace dapple::gltf {

/// Throws Error input when one mesh is placed again and again by the same matrix.
void check_crowding(const Scene& scene);

}  // namespace dapple::gltf
