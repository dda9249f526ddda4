// Lights without radiance: no rays are traced to them.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

[[nodiscard]] inline bool is_dark(const Light& light) { return light.radiance == V3f(0, 0, 0); }

}  // namespace dapple
