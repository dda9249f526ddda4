// Builds the BVH before quantization: nodes of up to eight children with exact boxes. In: boxes of
// primitives of any kind. Out: nodes, and the order of the primitives.
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

/// A node of up to eight children. Its inner children are contiguous in WideTree::nodes, in the
/// order of the slots.
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

/// Returns the number of blocks of eight that hold the primitives of the node's leaves.
inline std::uint32_t blocks_of(const WideNode& node) { return (node.leaf_primitives + 7u) / 8u; }

/// Builds in O(n log n), in parallel. The tree does not depend on the number of threads. `boxes`
/// must not be empty, and its boxes must be finite. The function reorders `boxes` so that each
/// leaf, of at most `leaf_size` primitives, is a range.
WideTree build_wide_tree(std::span<PrimitiveBox> boxes, std::uint32_t leaf_size);

/// Returns the maximum number of entries on the stack of a depth-first traversal of the tree.
std::uint32_t stack_needed(const WideTree& tree);

}  // namespace dapple
