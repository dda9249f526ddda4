// A coverage map whose cells all have the same opacity, one value for each axis.
#pragma once

#include "bvh/opacity/coverage_map.hpp"

namespace dapple {

inline CoverageMap uniform_map(const V3f& opacity) {
  CoverageMap map;
  for (int axis = 0; axis < 3; ++axis) map.transmittance[axis].fill(1.0f - opacity[axis]);
  return map;
}

}  // namespace dapple
