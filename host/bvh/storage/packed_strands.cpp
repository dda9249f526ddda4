#include "bvh/storage/packed_strands.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace dapple {
namespace {

using Segments = std::vector<StrandSegment>;

/// Sets `segments`, and the first of `lanes`, to those of the node's leaves, in the order of the
/// slots.
void gather(const WideTree& tree, const WideNode& node, std::span<const PrimitiveBox> order,
            const Mesh& mesh, const StrandJoints& joints, const std::vector<float>& opacities,
            Segments& segments, std::uint32_t* lanes) {
  segments.clear();
  for (const WideChild& child : tree.children_of(node)) {
    for (std::uint32_t i = 0; i < child.count; ++i) {
      const std::uint32_t index = order[child.first + i].primitive;
      segments.push_back(joints.segment(mesh, index));
      segments.back().opacity = opacities[index];
      *lanes++ = index;
    }
  }
}

/// Computes the boxes of the leaves of a node from its packed blocks.
void fit_leaves(WideTree& tree, const WideNode& node, std::span<const SegmentBlock> blocks) {
  unsigned next = 0;
  for (std::uint32_t c = 0; c < node.child_count; ++c) {
    WideChild& child = tree.children[node.first_child + c];
    if (child.count == 0) continue;
    child.box = {};
    for (std::uint32_t i = 0; i < child.count; ++i, ++next) {
      child.box.extendBy(bounds(unpack_segment(blocks[next / 8], next % 8)));
    }
  }
}

/// Computes the boxes of inner children and nodes. Children come after their parents, so one
/// backward loop is enough.
void fit_nodes(WideTree& tree) {
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    WideNode& node = tree.nodes[n];
    node.box = {};
    for (std::uint32_t c = 0; c < node.child_count; ++c) {
      WideChild& child = tree.children[node.first_child + c];
      if (child.count == 0) child.box = tree.nodes[child.first].box;
      node.box.extendBy(child.box);
    }
  }
}

}  // namespace

PackedStrands pack_strands(WideTree& tree, std::span<const PrimitiveBox> order, const Mesh& mesh,
                           const StrandJoints& joints, const std::vector<float>& opacities) {
  PackedStrands packed;
  std::uint32_t count = 0;
  for (const WideNode& node : tree.nodes) {
    packed.first_block.push_back(count);
    count += blocks_of(node);
  }
  packed.blocks.resize(count);
  packed.primitives.assign(8 * std::size_t{count}, kNoPrimitive);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, tree.nodes.size(), 1024), [&](const auto& range) {
        Segments segments;
        for (std::size_t n = range.begin(); n < range.end(); ++n) {
          const WideNode& node = tree.nodes[n];
          gather(tree, node, order, mesh, joints, opacities, segments,
                 packed.primitives.data() + 8 * std::size_t{packed.first_block[n]});
          const std::span all(segments);
          SegmentBlock* const blocks = packed.blocks.data() + packed.first_block[n];
          for (std::size_t i = 0; i < all.size(); i += 8) {
            blocks[i / 8] = pack_segments(all.subspan(i, std::min<std::size_t>(8, all.size() - i)));
          }
          fit_leaves(tree, node, {blocks, blocks_of(node)});
        }
      });
  fit_nodes(tree);
  return packed;
}

}  // namespace dapple
