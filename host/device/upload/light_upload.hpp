// Lights as the kernels sample them. In: a scene. Out: a record of each light, and the triangles of
// mesh lights.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/light_record.h"

namespace dapple {

/// Appends one record for each light of the scene, in order, and the triangles of its mesh lights,
/// in world space, in the order of their tree.
void pack_lights(const Scene& scene, std::vector<LightRecord>& records,
                 std::vector<EmitterTriangle>& emitters);

}  // namespace dapple
