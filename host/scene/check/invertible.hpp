// Whether rays can be carried into an instance. In: its matrix.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Whether a matrix and its inverse are finite. Instances with other matrices, such as those that
/// are scaled to zero, are not in the scene.
bool is_invertible(const M44f& matrix);

}  // namespace dapple
