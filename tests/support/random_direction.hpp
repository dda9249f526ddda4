// Random directions for tests.
#pragma once

#include <random>

#include "dapple/scene.hpp"

namespace dapple {

/// Uniform on the unit sphere.
inline V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  V3f d;
  do {
    for (int a = 0; a < 3; ++a) d[a] = normal(random);
  } while (d.length() < 1e-3f);
  return d.normalized();
}

}  // namespace dapple
