// What the surface area heuristic counts for nodes and leaves (MacDonald and Booth, 1990), over one
// test of a ray against a node's eight boxes.
#pragma once

namespace dapple {

/// A ray that hits a leaf's box has its block of up to eight triangles brought and met, which the
/// node's other leaves may share: most of it once, little for each primitive.
inline constexpr float kLeafCost = 0.7f;
inline constexpr float kPrimitiveCost = 0.2f;

inline float leaf_cost(float area, unsigned primitives) {
  return area * (kLeafCost + kPrimitiveCost * static_cast<float>(primitives));
}

}  // namespace dapple
