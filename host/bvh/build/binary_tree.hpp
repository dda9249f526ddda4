// A binary tree over a few thousand primitives, down to those that are not worth splitting.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/build/splitter.hpp"

namespace dapple {

struct BinaryNode {
  Box8 box;
  float area;                  ///< half_area() of the box
  std::uint32_t first, count;  ///< range of its primitives
  std::uint32_t right;         ///< index of the right child, the left being the next; 0: not split
};

/// All that the splitter makes of `whole`, which is at home; parents before children.
std::vector<BinaryNode> build_binary_tree(const Splitter& splitter, const Part& whole);

}  // namespace dapple
