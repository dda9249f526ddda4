// Costs of nodes and leaves for the surface area heuristic (MacDonald and Booth, 1990), in units of
// one test of a ray against a node's eight boxes.
#pragma once

namespace dapple {

/// A ray that hits the box of a leaf loads and intersects a block of up to eight triangles, which
/// other leaves of the node may share. Therefore the cost of a leaf is mostly constant and grows
/// little with the number of primitives.
inline constexpr float kLeafCost = 0.7f;
inline constexpr float kPrimitiveCost = 0.2f;

inline float leaf_cost(float area, unsigned primitives) {
  return area * (kLeafCost + kPrimitiveCost * static_cast<float>(primitives));
}

}  // namespace dapple
