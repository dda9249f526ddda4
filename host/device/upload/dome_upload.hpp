// Dome lights as kernels/lights/dome.clh samples them. In: a scene. Out: cumulative distributions
// and radiance of its domes, as floats.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/light_record.h"

namespace dapple {

/// Appends the floats of each dome to `floats`, and stores in its record where they begin. They
/// are: the rows' cumulative shares of the light, then the texels' cumulative shares of each row,
/// then RGB of each texel. `records` are those of pack_lights(); the domes have a mean luminance of
/// 1 (finalize_domes()).
void pack_domes(const Scene& scene, std::vector<LightRecord>& records, std::vector<float>& floats);

}  // namespace dapple
