#include "bvh/build/block_layout.hpp"

#include <algorithm>

#include "dapple/shared/bvh_node.h"

namespace dapple {
namespace {

/// Number of blocks that are kept to be filled: of the last nodes, for they are near in space.
/// With more, hardly more lanes are filled (experiment 122).
constexpr std::size_t kOpenBlocks = 8;

/// A block whose last lanes are free.
struct OpenBlock {
  std::uint32_t block = 0, used = 0;
};

/// The open blocks, the oldest first.
class OpenBlocks {
 public:
  /// Takes out the fullest open block, numbered `from` or higher, in which `triangles` more fit
  /// before lane `last`. Returns a block with no lane used if there is none.
  OpenBlock take(std::uint32_t from, std::uint32_t triangles, std::uint32_t last) {
    std::size_t best = open_.size();
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const bool fits = open_[i].block >= from && open_[i].used + triangles <= last;
      if (fits && (best == open_.size() || open_[i].used > open_[best].used)) best = i;
    }
    if (best == open_.size()) return {};
    const OpenBlock taken = open_[best];
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(best));
    return taken;
  }

  void add(OpenBlock block) {
    if (open_.size() == kOpenBlocks) open_.erase(open_.begin());
    open_.push_back(block);
  }

 private:
  std::vector<OpenBlock> open_;
};

}  // namespace

BlockLayout lay_out_blocks(const WideTree& tree) {
  BlockLayout layout;
  layout.prim_base.reserve(tree.nodes.size());
  OpenBlocks open;
  for (const WideNode& node : tree.nodes) {
    const std::uint32_t triangles = node.leaf_primitives, needed = blocks_of(node);
    if (triangles == 0) {
      layout.prim_base.push_back(0);
      continue;
    }
    // The blocks of a node are consecutive: only the last can be continued by new ones.
    const std::uint32_t from = needed == 1 || layout.blocks == 0 ? 0 : layout.blocks - 1;
    const std::uint32_t last = std::min<std::uint32_t>(8 * needed, DAPPLE_MAX_PRIMITIVES);
    OpenBlock first = open.take(from, triangles, last);
    const bool shares = first.used > 0;
    if (!shares) first.block = layout.blocks;
    layout.prim_base.push_back(first.block | first.used << DAPPLE_FIRST_LANE_SHIFT);
    layout.blocks += shares ? needed - 1 : needed;
    const std::uint32_t end = first.used + triangles;
    if (end % 8 != 0) open.add({first.block + needed - 1, end % 8});
  }
  return layout;
}

}  // namespace dapple
