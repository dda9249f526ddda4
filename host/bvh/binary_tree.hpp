// A binary BVH over boxes, built top-down by binned SAH. Input of the collapse to wide
// nodes; knows nothing of what is inside the boxes.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// The box of one primitive and its index in the caller's list.
struct PrimitiveBox {
  V3f lower;
  std::uint32_t primitive;
  V3f upper;
  std::uint32_t spare;
};

/// Covers order[first, first + count). `left` is 0 for a leaf; the right child is at
/// `right`. Slots that no node uses have count 0.
struct BinaryNode {
  Box3f box;
  std::uint32_t first, count;
  std::uint32_t left, right;
};

struct BinaryTree {
  std::vector<BinaryNode> nodes;    ///< node 0 is the root
  std::vector<PrimitiveBox> order;  ///< the primitives, reordered so that leaves are ranges
};

/// Half of the box's surface: xy + yz + zx, in square metres; 0 for an empty box.
inline float half_area(const Box3f& box) {
  if (box.isEmpty()) return 0.0f;
  const V3f size = box.max - box.min;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Builds in O(n log n), in parallel, the same tree whatever the thread count. `boxes` is
/// not empty and has finite boxes; leaves hold at most `leaf_size` primitives.
BinaryTree build_binary_tree(std::vector<PrimitiveBox> boxes, std::uint32_t leaf_size);

}  // namespace dapple
