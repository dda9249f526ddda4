// What the ablations need of every node beside its stored opacity, gathered bottom-up:
// opacity composed without coverage maps, and how the normals lie.
#pragma once

#include <array>
#include <vector>

#include "accuracy/subtree.hpp"

namespace dapple::bench {

/// Of one child slot.
struct Composition {
  V3f rectangles{0.0f};  ///< opacity along each axis, children as independent rectangles
  /// Second moments of the normals, weighted by area and opacity: xx, yy, zz, xy, yz, zx.
  std::array<double, 6> moments{};
  /// The moments' off-diagonals xy, yz, zx over the roots of the diagonals.
  [[nodiscard]] V3f correlation() const;
};

/// By node, then slot; nodes of the top level stay empty.
using Compositions = std::vector<std::array<Composition, DAPPLE_BVH_WIDTH>>;

Compositions compose(const SceneBvh& bvh, const Scene& scene);

}  // namespace dapple::bench
