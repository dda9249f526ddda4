// Whether numbers are finite: of vectors and of matrices.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <cmath>

namespace dapple {

inline bool is_finite(const Imath::V3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool is_finite(const Imath::M44f& matrix) {
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!std::isfinite(matrix[i][k])) return false;
    }
  }
  return true;
}

}  // namespace dapple
