// Makes a binary tree better after it is built: subtrees move to where they cost less (Meister and
// Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", 2018).
#pragma once

#include <span>
#include <vector>

#include "bvh/build/binary_tree.hpp"

namespace dapple {

/// In each of so many rounds every node that lowers the sum of areas elsewhere moves there, largest
/// first. `boxes`, which leaves are ranges of, are put in the new order. A tree that would become
/// very deep stays as it is.
void reinsert_subtrees(int rounds, std::span<PrimitiveBox> boxes, std::vector<BinaryNode>& tree);

}  // namespace dapple
