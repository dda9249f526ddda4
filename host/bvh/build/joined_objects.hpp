// Objects' arrays one after the other, as kernels take them, with indices that count from the
// scene's first node, block of either kind and textured triangle.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bvh/storage/bvh_cache.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// What comes before an object in each of the scene's arrays.
struct ObjectOffsets {
  std::uint32_t node = 0, block = 0, segments = 0, textured = 0;
};

/// One for each object, and one more for what comes after them all. Throws Error failed when there
/// are more than indices can tell.
std::vector<ObjectOffsets> lay_out(const std::vector<FinishedObject>& objects,
                                   const std::string& source);

/// Fills the scene's arrays: the objects', which give up theirs, then the top level's nodes.
/// A single object's are taken as they are, still mapped from its file when they came from one.
void join(SceneBvh& bvh, std::vector<FinishedObject>& objects,
          const std::vector<ObjectOffsets>& offsets, std::vector<BvhNode> top);

/// The arrays of a SceneBvh as vectors that may be written to.
struct ChangeableArrays {
  std::span<BvhNode> nodes;
  std::span<TriangleBlock> blocks;
};

/// As join(), but into arrays that may change later, with room for `spare` nodes at the end.
ChangeableArrays join_changeable(SceneBvh& bvh, std::vector<FinishedObject>& objects,
                                 const std::vector<ObjectOffsets>& offsets, std::size_t spare);

/// A copy of the object between the offsets `first` and `end`, with indices relative to itself.
FinishedObject separate(const SceneBvh& bvh, const ObjectSummary& summary,
                        const ObjectOffsets& first, const ObjectOffsets& end);

}  // namespace dapple
