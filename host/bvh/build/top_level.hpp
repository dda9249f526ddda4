// Builds the BVH over the scene's instances, with the same nodes as objects and one instance in a
// leaf.
#pragma once

#include <vector>

#include "bvh/build/joined_objects.hpp"
#include "bvh/build/object_bvh.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// Sets all of `bvh` that depends on where the instances are, and returns the top level's nodes,
/// which come after all objects'; none when the only object lies in world space. `objects` and
/// `offsets`: of each mesh. Throws Error input when nothing can be hit, failed when the tree is too
/// deep for the kernels' stack.
std::vector<BvhNode> place_instances(SceneBvh& bvh, const Scene& scene,
                                     const std::vector<ObjectSummary>& objects,
                                     const std::vector<ObjectOffsets>& offsets);

/// Share of the lanes of all blocks that hold a triangle or a segment, [0,1].
double lane_use(const SceneBvh& bvh);

/// Fills the counts of triangles and segments, and `sah_cost`.
void describe_objects(BvhStatistics& statistics, const std::vector<ObjectSummary>& objects);

}  // namespace dapple
