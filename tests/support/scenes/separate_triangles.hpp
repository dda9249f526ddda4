// Triangles that share no vertex, for tests of what finds that vertices lie at one place.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::test {

/// Each three positions are a triangle. All have the material 0.
inline Mesh separate_triangles(std::vector<V3f> positions) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.indices.push_back(i);
  mesh.materials.resize(mesh.positions.size() / 3, 0);
  return mesh;
}

}  // namespace dapple::test
