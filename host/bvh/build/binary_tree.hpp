// A binary BVH over a range of primitives. In: a range and the splitter. Out: nodes, down to ranges
// that the splitter declares leaves.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/build/splitter.hpp"

namespace dapple {

struct BinaryNode {
  Box8 box;
  float area;                  ///< half_area() of the box
  std::uint32_t first, count;  ///< range of its primitives
  std::uint32_t right;         ///< index of the right child; the left is the next node; 0: a leaf
};

/// Splits `whole`, which must be in Splitter::result(), down to leaves. Parents come before their
/// children.
std::vector<BinaryNode> build_binary_tree(const Splitter& splitter, const Part& whole);

}  // namespace dapple
