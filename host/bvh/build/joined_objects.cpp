#include "bvh/build/joined_objects.hpp"

#include <fmt/format.h>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Converts indices. `sign`: 1 from the object's to the scene's, -1 from the scene's to the
/// object's.
void shift(BvhNode& node, const ObjectOffsets& by, int sign) {
  const std::uint32_t first = node.prim_base & DAPPLE_SEGMENTS ? by.segments : by.block;
  node.child_base += static_cast<std::uint32_t>(sign) * by.node;
  node.prim_base += static_cast<std::uint32_t>(sign) * first;
}

void shift(TriangleBlock& block, const ObjectOffsets& by, int sign) {
  for (float& opacity : block.opacity) {
    if (opacity < 0.0f) opacity -= static_cast<float>(sign) * static_cast<float>(by.textured);
  }
}

void shift(SegmentBlock&, const ObjectOffsets&, int) {}
void shift(TexturedTriangle&, const ObjectOffsets&, int) {}
void shift(std::uint32_t&, const ObjectOffsets&, int) {}

/// Concatenates the parts' values, each shifted by its offsets, with `spare` more elements. Parts
/// are freed one by one, so that only one is in memory twice.
template <class T>
LargeVector<T> values_of(std::span<ConstArray<T>* const> parts,
                         std::span<const ObjectOffsets> offsets, std::size_t spare) {
  std::size_t count = spare;
  for (const ConstArray<T>* part : parts) count += part->size();
  LargeVector<T> values;
  values.reserve(count);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const ConstArray<T> part = std::exchange(*parts[p], {});
    const std::size_t first = values.size();
    values.insert(values.end(), part.begin(), part.end());
    for (std::size_t i = first; i < values.size(); ++i) shift(values[i], offsets[p], 1);
  }
  values.resize(count);
  return values;
}

/// Concatenates the parts' values. A single part has offset 0, so it is not copied.
template <class T>
ConstArray<T> joined(std::span<ConstArray<T>* const> parts,
                     std::span<const ObjectOffsets> offsets) {
  ConstArray<T>* only = nullptr;
  std::size_t filled = 0;
  for (ConstArray<T>* part : parts) {
    if (part->empty()) continue;
    only = part;
    ++filled;
  }
  if (filled == 1) return std::exchange(*only, {});
  return values_of<T>(parts, offsets, 0);
}

template <class T>
std::vector<ConstArray<T>*> arrays_of(std::vector<FinishedObject>& objects,
                                      ConstArray<T> FinishedObject::*array) {
  std::vector<ConstArray<T>*> parts;
  for (FinishedObject& object : objects) parts.push_back(&(object.*array));
  return parts;
}

template <class T>
ConstArray<T> part_of(const ConstArray<T>& all, std::size_t first, std::size_t end,
                      const ObjectOffsets& offsets) {
  std::vector<T> values(all.begin() + first, all.begin() + end);
  for (T& value : values) shift(value, offsets, -1);
  return values;
}

/// Refitting does not change segments: strands that move are rebuilt.
void join_constant(SceneBvh& bvh, std::vector<FinishedObject>& objects,
                   const std::vector<ObjectOffsets>& offsets) {
  bvh.segments = joined<SegmentBlock>(arrays_of(objects, &FinishedObject::segments), offsets);
  bvh.primitives = joined<std::uint32_t>(arrays_of(objects, &FinishedObject::primitives), offsets);
  bvh.objects = offsets;
}

}  // namespace

std::vector<ObjectOffsets> lay_out(const std::vector<FinishedObject>& objects,
                                   const std::string& source) {
  std::vector<ObjectOffsets> offsets;
  std::size_t nodes = 0, blocks = 0, segments = 0, textured = 0;
  const auto push = [&] {
    // The top bit of a stack entry marks instances. The top bit of a primitive's index, of which
    // each block has eight, marks segments. The index of a textured triangle must fit a float.
    constexpr std::uint32_t kMaxBlocks = DAPPLE_MAX_BLOCKS;
    static_assert(kMaxBlocks <= DAPPLE_SEGMENTS / 8);
    if (nodes >= DAPPLE_SEGMENTS || blocks > kMaxBlocks || segments > kMaxBlocks ||
        textured >= DAPPLE_MAX_TEXTURED_TRIANGLES) {
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
          const std::vector<ObjectOffsets>& offsets, LargeVector<BvhNode> top) {
  ConstArray<BvhNode> top_nodes(std::move(top));
  std::vector<ConstArray<BvhNode>*> nodes = arrays_of(objects, &FinishedObject::nodes);
  nodes.push_back(&top_nodes);
  std::vector<ObjectOffsets> node_offsets = offsets;
  node_offsets.back() = {};  // the top level's indices are already absolute
  bvh.nodes = joined<BvhNode>(nodes, node_offsets);
  bvh.blocks = joined<TriangleBlock>(arrays_of(objects, &FinishedObject::blocks), offsets);
  bvh.textured = joined<TexturedTriangle>(arrays_of(objects, &FinishedObject::textured), offsets);
  join_constant(bvh, objects, offsets);
}

ChangeableArrays join_changeable(SceneBvh& bvh, std::vector<FinishedObject>& objects,
                                 const std::vector<ObjectOffsets>& offsets, std::size_t spare) {
  const auto nodes = std::make_shared<LargeVector<BvhNode>>(
      values_of<BvhNode>(arrays_of(objects, &FinishedObject::nodes), offsets, spare));
  const auto blocks = std::make_shared<LargeVector<TriangleBlock>>(
      values_of<TriangleBlock>(arrays_of(objects, &FinishedObject::blocks), offsets, 0));
  const auto textured = std::make_shared<LargeVector<TexturedTriangle>>(
      values_of<TexturedTriangle>(arrays_of(objects, &FinishedObject::textured), offsets, 0));
  bvh.nodes = {*nodes, nodes};
  bvh.blocks = {*blocks, blocks};
  bvh.textured = {*textured, textured};
  join_constant(bvh, objects, offsets);
  return {*nodes, *blocks, *textured};
}

FinishedObject separate(const SceneBvh& bvh, const ObjectSummary& summary,
                        const ObjectOffsets& first, const ObjectOffsets& end) {
  FinishedObject object;
  static_cast<ObjectSummary&>(object) = summary;
  object.nodes = part_of(bvh.nodes, first.node, end.node, first);
  object.blocks = part_of(bvh.blocks, first.block, end.block, first);
  object.segments = part_of(bvh.segments, first.segments, end.segments, first);
  object.textured = part_of(bvh.textured, first.textured, end.textured, first);
  object.primitives = part_of(bvh.primitives, first.lane(), end.lane(), first);
  return object;
}

}  // namespace dapple
