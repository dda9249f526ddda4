// The binary tree collapsed to nodes of up to eight children, not yet quantized.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/binary_tree.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

struct WideChild {
  Box3f box;
  std::uint32_t first =
      0;  ///< leaf: first primitive in BinaryTree::order; inner: index of its node
  std::uint32_t count = 0;  ///< leaf: primitives; inner: 0
};

/// Inner children of a node lie one after the other in WideTree::nodes, in slot order.
struct WideNode {
  Box3f box;
  std::uint32_t first_child = 0;  ///< in WideTree::children
  std::uint32_t child_count = 0;
  std::uint32_t primitives = 0;  ///< in the whole subtree
};

struct WideTree {
  std::vector<WideNode> nodes;  ///< node 0 is the root; children come after their parents
  std::vector<WideChild> children;

  [[nodiscard]] std::span<const WideChild> children_of(const WideNode& node) const {
    return {&children[node.first_child], node.child_count};
  }
};

WideTree collapse(const BinaryTree& tree);

/// Entries that a depth-first traversal of the tree may have on its stack at once.
std::uint32_t stack_needed(const WideTree& tree);

}  // namespace dapple
