// The wood of a broad-leaved tree as a graph of nodes. In: a seed and a height; out: positions,
// parents and radii of the nodes, in metres.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Node 0 is the trunk's foot, at the origin; it is its own parent. Every other node has a larger
/// number than its parent.
struct TreeSkeleton {
  std::vector<V3f> positions;
  std::vector<std::uint32_t> parents;
  std::vector<float> radii;
  std::vector<std::uint32_t> twigs;  ///< the nodes that bear leaves, never empty

  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

/// Approximate largest radius of the crown, divided by the tree's height.
inline constexpr float kCrownRadius = 0.33f;

TreeSkeleton grow_skeleton(std::uint32_t seed, float height_m);

}  // namespace dapple
