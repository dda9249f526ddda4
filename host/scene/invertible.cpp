#include "scene/invertible.hpp"

#include <cmath>

namespace dapple {
namespace {

bool is_finite(const M44f& matrix) {
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!std::isfinite(matrix[i][k])) return false;
    }
  }
  return true;
}

}  // namespace

// Uses Imath's inverse(), which also transforms the rays later. It returns the identity for a
// matrix without an inverse.
bool is_invertible(const M44f& matrix) {
  if (!is_finite(matrix)) return false;
  const M44f inverse = matrix.inverse();
  return is_finite(inverse) && (inverse != M44f{} || matrix == M44f{});
}

}  // namespace dapple
