// Improves a binary tree after it is built: moves subtrees to where they cost less (Meister and
// Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", 2018).
#pragma once

#include <span>
#include <vector>

#include "bvh/build/binary_tree.hpp"

namespace dapple {

/// Runs `rounds` rounds. Each round moves nodes to other positions if this reduces the sum of
/// areas, in descending order of the nodes' areas. Reorders `boxes`, since leaves are ranges of it.
/// A tree that would become too deep is not changed.
void reinsert_subtrees(int rounds, std::span<PrimitiveBox> boxes, std::vector<BinaryNode>& tree);

}  // namespace dapple
