// Lights as the kernels sample them.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/light_record.h"

namespace dapple {

/// One record a light of the scene, in order, and the triangles of its mesh lights in
/// world space with their shares of the light's area.
void pack_lights(const Scene& scene, std::vector<LightRecord>& records,
                 std::vector<EmitterTriangle>& emitters);

}  // namespace dapple
