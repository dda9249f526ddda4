// Packs the segments of strands in the leaves of a tree into blocks, and fits the boxes of the tree
// to the quantized segments.
#pragma once

#include <span>
#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/storage/large_pages.hpp"
#include "bvh/storage/segment_block.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

struct PackedStrands {
  LargeVector<SegmentBlock> blocks;
  std::vector<std::uint32_t> first_block;  ///< of each node
  std::vector<std::uint32_t> primitives;   ///< by lane: index in the mesh, or kNoPrimitive
};

/// Packs in the order of the slots; each node begins a new block. `opacities`: one for each segment
/// of the mesh. Sets the boxes of `tree` to those of the segments after rounding in blocks.
PackedStrands pack_strands(WideTree& tree, std::span<const PrimitiveBox> order, const Mesh& mesh,
                           const StrandJoints& joints, const std::vector<float>& opacities);

}  // namespace dapple
