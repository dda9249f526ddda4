// Builds the BVH over the scene's instances, with the same nodes as objects and one instance in a
// leaf.
#pragma once

#include <vector>

#include "bvh/build/joined_objects.hpp"
#include "bvh/build/object_bvh.hpp"
#include "dapple/bvh.hpp"

namespace dapple {

/// Sets the members of `bvh` that depend on the transforms of the instances. Returns the nodes of
/// the top level, which follow the nodes of all objects; none if there is only one object and it is
/// in world space. `objects`: of each mesh; `offsets`: lay_out(). Throws Error input if nothing can
/// be hit, failed if the BVH is too deep for the kernels' stack.
LargeVector<BvhNode> place_instances(SceneBvh& bvh, const Scene& scene,
                                     const std::vector<ObjectSummary>& objects,
                                     const std::vector<ObjectOffsets>& offsets);

/// Share of the lanes of all blocks that hold a triangle or a segment, [0,1].
double lane_use(const SceneBvh& bvh);

/// Fills the counts of triangles and segments, and `sah_cost`.
void describe_objects(BvhStatistics& statistics, const std::vector<ObjectSummary>& objects);

}  // namespace dapple
