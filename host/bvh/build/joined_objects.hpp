// Concatenates the arrays of all objects for the kernels. In: finished objects, whose indices count
// from their own first elements. Out: arrays of the scene, whose indices count from the scene's
// first node, block of either kind and textured triangle.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bvh/storage/bvh_cache.hpp"
#include "bvh/storage/large_pages.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// Returns one entry for each object, and one more with the totals. Throws Error failed if there
/// are more elements than indices can represent.
std::vector<ObjectOffsets> lay_out(const std::vector<FinishedObject>& objects,
                                   const std::string& source);

/// Fills the arrays of the scene with those of the objects, which become empty, and with the nodes
/// of the top level at the end. An array that only one object fills is taken without a copy; it may
/// stay mapped from a cache file.
void join(SceneBvh& bvh, std::vector<FinishedObject>& objects,
          const std::vector<ObjectOffsets>& offsets, LargeVector<BvhNode> top);

/// The arrays of a SceneBvh as vectors that may be written to.
struct ChangeableArrays {
  std::span<BvhNode> nodes;
  std::span<TriangleBlock> blocks;
  std::span<TexturedTriangle> textured;
};

/// As join(), but into arrays that may change later, with room for `spare` nodes at the end.
ChangeableArrays join_changeable(SceneBvh& bvh, std::vector<FinishedObject>& objects,
                                 const std::vector<ObjectOffsets>& offsets, std::size_t spare);

/// Returns a copy of the object between the offsets `first` and `end`. Its indices count from its
/// own first elements.
FinishedObject separate(const SceneBvh& bvh, const ObjectSummary& summary,
                        const ObjectOffsets& first, const ObjectOffsets& end);

}  // namespace dapple
