// Packs the segments of a tree's leaves into blocks, and enlarges the tree's boxes to what the
// quantized blocks hold.
#pragma once

#include <span>
#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/storage/segment_block.hpp"

namespace dapple {

struct PackedStrands {
  std::vector<SegmentBlock> blocks;
  std::vector<std::uint32_t> first_block;  ///< of each node
};

/// In slot order, padded to whole blocks a node; `opacities` are the mesh's segments'. The boxes of
/// `tree` become those of the segments as blocks round them.
PackedStrands pack_strands(WideTree& tree, std::span<const PrimitiveBox> order, const Mesh& mesh,
                           const StrandJoints& joints, const std::vector<float>& opacities);

}  // namespace dapple
