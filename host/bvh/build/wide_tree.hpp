// The tree before quantization: nodes of up to eight children with exact boxes. In: boxes of
// primitives of any kind. Out: nodes and an order of the primitives.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/build/primitive_box.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

struct WideChild {
  Box3f box;
  std::uint32_t first = 0;  ///< leaf: first of its primitives; inner: index of its node
  std::uint32_t count = 0;  ///< leaf: primitives; inner: 0
};

/// Inner children of a node lie one after the other in WideTree::nodes, in slot order.
struct WideNode {
  Box3f box;
  std::uint32_t first_child = 0;  ///< in WideTree::children
  std::uint32_t child_count = 0;
  std::uint32_t primitives = 0;       ///< in the whole subtree
  std::uint32_t leaf_primitives = 0;  ///< in the children that are leaves
};

struct WideTree {
  std::vector<WideNode> nodes;  ///< node 0 is the root; children come after their parents
  std::vector<WideChild> children;

  [[nodiscard]] std::span<const WideChild> children_of(const WideNode& node) const {
    return {&children[node.first_child], node.child_count};
  }
};

/// Blocks of eight that the primitives of a node's leaves take.
inline std::uint32_t blocks_of(const WideNode& node) { return (node.leaf_primitives + 7u) / 8u; }

/// Builds in O(n log n), in parallel. The tree does not depend on the number of threads. `boxes` is
/// not empty and has finite boxes; it is reordered so that leaves, of at most `leaf_size`
/// primitives, are ranges.
WideTree build_wide_tree(std::span<PrimitiveBox> boxes, std::uint32_t leaf_size);

/// Entries that a depth-first traversal of the tree may have on its stack at once.
std::uint32_t stack_needed(const WideTree& tree);

}  // namespace dapple
