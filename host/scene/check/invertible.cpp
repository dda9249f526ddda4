#include "scene/check/invertible.hpp"

#include "scene/check/finite.hpp"

namespace dapple {

// Uses Imath's inverse(), which also transforms the rays later. It returns the identity for a
// matrix without an inverse.
bool is_invertible(const M44f& matrix) {
  if (!is_finite(matrix)) return false;
  const M44f inverse = matrix.inverse();
  return is_finite(inverse) && (inverse != M44f{} || matrix == M44f{});
}

}  // namespace dapple
