#include "bvh/joined_objects.hpp"

#include <fmt/format.h>

#include "dapple/error.hpp"

namespace dapple {
namespace {

void shift(BvhNode& node, const ObjectOffsets& by) {
  node.child_base += by.node;
  node.prim_base += node.prim_base & DAPPLE_SEGMENTS ? by.segments : by.block;
}

void shift(TriangleBlock& block, const ObjectOffsets& by) {
  for (float& opacity : block.opacity) {
    if (opacity < 0.0f) opacity -= static_cast<float>(by.textured);
  }
}

void shift(SegmentBlock&, const ObjectOffsets&) {}
void shift(TexturedTriangle&, const ObjectOffsets&) {}

/// Each part's values shifted by its offsets. The first that are not empty have offsets 0, so that
/// alone they need not be copied. Parts are emptied on the way, to need memory for one twice.
template <class T>
ConstArray<T> joined(std::span<ConstArray<T>* const> parts,
                     std::span<const ObjectOffsets> offsets) {
  std::size_t count = 0, filled = 0;
  for (const ConstArray<T>* part : parts) {
    count += part->size();
    filled += !part->empty();
  }
  std::vector<T> values;
  if (filled != 1) values.reserve(count);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const ConstArray<T> part = std::exchange(*parts[p], {});
    if (part.empty()) continue;
    if (filled == 1) return part;
    const std::size_t first = values.size();
    values.insert(values.end(), part.begin(), part.end());
    for (std::size_t i = first; i < values.size(); ++i) shift(values[i], offsets[p]);
  }
  return values;
}

}  // namespace

std::vector<ObjectOffsets> lay_out(const std::vector<FinishedObject>& objects,
                                   const std::string& source) {
  std::vector<ObjectOffsets> offsets;
  std::size_t nodes = 0, blocks = 0, segments = 0, textured = 0;
  const auto push = [&] {
    // The stack's top bit marks instances, that of a primitive's number, eight to a block, marks
    // segments; a textured triangle's index must fit a float.
    constexpr std::uint32_t kMostBlocks = DAPPLE_SEGMENTS / 8;
    if (nodes >= DAPPLE_SEGMENTS || blocks > kMostBlocks || segments > kMostBlocks ||
        textured >= 1u << 24) {
      throw Error(ErrorKind::failed,
                  fmt::format("{}: too many triangles for the BVH's indices", source));
    }
    offsets.push_back({static_cast<std::uint32_t>(nodes), static_cast<std::uint32_t>(blocks),
                       static_cast<std::uint32_t>(segments), static_cast<std::uint32_t>(textured)});
  };
  push();
  for (const FinishedObject& object : objects) {
    nodes += object.nodes.size();
    blocks += object.blocks.size();
    segments += object.segments.size();
    textured += object.textured.size();
    push();
  }
  return offsets;
}

void join(SceneBvh& bvh, std::vector<FinishedObject>& objects,
          const std::vector<ObjectOffsets>& offsets, std::vector<BvhNode> top) {
  ConstArray<BvhNode> top_nodes(std::move(top));
  std::vector<ConstArray<BvhNode>*> nodes;
  std::vector<ConstArray<TriangleBlock>*> blocks;
  std::vector<ConstArray<SegmentBlock>*> segments;
  std::vector<ConstArray<TexturedTriangle>*> textured;
  for (FinishedObject& object : objects) {
    nodes.push_back(&object.nodes);
    blocks.push_back(&object.blocks);
    segments.push_back(&object.segments);
    textured.push_back(&object.textured);
  }
  nodes.push_back(&top_nodes);
  std::vector<ObjectOffsets> node_offsets = offsets;
  node_offsets.back() = {};  // the top level's indices already count so
  bvh.nodes = joined<BvhNode>(nodes, node_offsets);
  bvh.blocks = joined<TriangleBlock>(blocks, offsets);
  bvh.segments = joined<SegmentBlock>(segments, offsets);
  bvh.textured = joined<TexturedTriangle>(textured, offsets);
}

}  // namespace dapple
