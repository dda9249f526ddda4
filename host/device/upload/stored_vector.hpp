// Vectors as the records of kernels hold them. In and out: three floats.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

inline void store(const V3f& from, float (&to)[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

inline V3f vector_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace dapple
