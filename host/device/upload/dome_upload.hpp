// Dome lights as the kernels sample them.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/light_record.h"

namespace dapple {

/// Tells each dome's record where its floats begin and appends them: the rows' cumulative shares of
/// the light, within each row its texels', then RGB texel by texel. Of domes of mean luminance 1:
/// finalize_domes().
void pack_domes(const Scene& scene, std::vector<LightRecord>& records, std::vector<float>& floats);

}  // namespace dapple
