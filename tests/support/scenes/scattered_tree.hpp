// A procedural tree whose leaves have moved so far that a refitted BVH is slow.
#pragma once

#include "support/scenes/scene_on_device.hpp"
#include "support/scenes/swaying_tree.hpp"

namespace dapple::motion {

/// The scene with each leaf moved by a random offset of up to `by` metres along each axis.
inline Scene scattered(const Scene& still, float by) {
  Scene scene = still;
  scene_test::Points points(3);
  Mesh& mesh = scene.meshes[0];
  for (std::size_t v = first_leaf_vertex(scene, mesh); v + 4 <= mesh.positions.size(); v += 4) {
    const V3f off = points.in_cube(by);
    for (std::size_t k = 0; k < 4; ++k) mesh.positions[v + k] += off;
  }
  return scene;
}

}  // namespace dapple::motion
