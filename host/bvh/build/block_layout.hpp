// Lays the triangles of nodes out in blocks of eight lanes. In: a wide tree. Out: where each node's
// triangles begin. Nodes share blocks, but none needs more blocks than it would alone: rays test no
// more of them.
#pragma once

#include <cstdint>
#include <vector>

#include "bvh/build/wide_tree.hpp"

namespace dapple {

struct BlockLayout {
  std::vector<std::uint32_t> prim_base;  ///< BvhNode::prim_base of each node; 0: no triangles
  std::uint32_t blocks = 0;              ///< used by all nodes together
};

/// Fills blocks that nodes left partly empty with the triangles of the next nodes that fit.
BlockLayout lay_out_blocks(const WideTree& tree);

}  // namespace dapple
