// Data of every node for the ablations, computed bottom-up. In: a BVH and its scene. Out: opacities
// that are composed without coverage maps, and moments of the normals.
#pragma once

#include <array>
#include <vector>

#include "accuracy/subtree.hpp"

namespace dapple::bench {

/// The data of one child slot.
struct Composition {
  V3f rectangles{0.0f};  ///< opacity along each axis, if children are independent rectangles
  /// Second moments of the normals, weighted by area and opacity: xx, yy, zz, xy, yz, zx.
  std::array<double, 6> moments{};
  /// The off-diagonal moments xy, yz, zx, divided by the square roots of the diagonal ones.
  [[nodiscard]] V3f correlation() const;
};

/// By node, then by slot. Nodes of the top level are empty.
using Compositions = std::vector<std::array<Composition, DAPPLE_BVH_WIDTH>>;

Compositions compose(const SceneBvh& bvh, const Scene& scene);

}  // namespace dapple::bench
