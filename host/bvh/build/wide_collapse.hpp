// Chooses which subtrees of a binary tree become children of nodes of eight and which become
// leaves, so that the cost by the surface area heuristic is minimal (Ylitie, Karras, Laine,
// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", 2017).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "bvh/build/binary_tree.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

class CheapestNodes {
 public:
  /// `tree` must outlive the object. Leaves have at most `leaf_size` primitives.
  CheapestNodes(std::span<const BinaryNode> tree, std::uint32_t leaf_size);

  [[nodiscard]] bool is_leaf(std::uint32_t node) const { return costs_[node].leaf; }

  /// Indices of binary nodes, from left to right.
  struct Children {
    std::array<std::uint32_t, DAPPLE_BVH_WIDTH> node;
    unsigned count = 0;
  };
  /// Returns the children of the node of eight that replaces binary `node`; of a leaf, the node
  /// itself.
  [[nodiscard]] Children children_of(std::uint32_t node) const;

 private:
  /// The cheapest ways to turn a subtree into 1 to 8 children of a node.
  struct CollapseCosts {
    /// cost[n - 1]: with at most n children. The entry for 8 is for a node, with at least 2.
    std::array<float, DAPPLE_BVH_WIDTH> cost;
    std::array<std::uint8_t, DAPPLE_BVH_WIDTH> left_children;  ///< how many are in the left subtree
    bool leaf = false;  ///< whether the subtree as one child is a leaf
  };

  [[nodiscard]] CollapseCosts costs_of(const BinaryNode& node, const CollapseCosts& left,
                                       const CollapseCosts& right) const;
  void add_children(std::uint32_t node, unsigned max_children, Children& children) const;
  void divide(std::uint32_t node, unsigned max_children, Children& children) const;

  std::span<const BinaryNode> tree_;
  std::uint32_t leaf_size_;
  std::vector<CollapseCosts> costs_;
};

}  // namespace dapple
