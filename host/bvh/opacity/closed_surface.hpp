// Finds closed surfaces, such as twigs, trunks and stones. Their front always occludes their back,
// so the opacity of a node must not count both.
#pragma once

#include <span>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Which triangles of the mesh belong to closed surfaces: pieces of opaque triangles (opacity
/// 1) connected by their vertices' indices, whose area vectors cancel but for a tenth, so that
/// twigs with open ends count. One entry a triangle; empty when there are none.
std::vector<bool> closed_triangles(const Mesh& mesh, std::span<const float> opacities);

/// Projected areas along x, y, z, each times its opacity, of what lies in a node.
struct SurfaceAreas {
  V3f front{0, 0, 0};  ///< of closed surfaces, facing the positive axis
  V3f back{0, 0, 0};   ///< of closed surfaces, facing away from it
  V3f other{0, 0, 0};

  /// A surface with this area vector, square metres.
  void add(const V3f& area, float opacity, bool closed);
  void add(const SurfaceAreas& areas);
};

/// Of two nodes seen along `axis`, the share of the smaller that is the back of what the larger
/// has the front of, or the reverse, [0,1].
float enclosed_share(const SurfaceAreas& a, const SurfaceAreas& b, int axis);

}  // namespace dapple
