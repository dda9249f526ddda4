// The outlines of segments of strands along an axis: strips that face the axis.
#pragma once

#include <array>
#include <span>

#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "bvh/storage/strand_segment.hpp"

namespace dapple {

/// The segment's outline along `axis` as two triangles across the axis, edge to edge.
std::array<CoveringTriangle, 2> facing_strip(const StrandSegment& segment, int axis);

/// Adds the segment's normals and projected areas.
void add_surface(const StrandSegment& segment, NormalMoments& normals, SurfaceAreas& areas);

/// Whether segments of a leaf are a single one's continuations, in any order in which each meets
/// one before it: end to end they hide hardly anything of each other.
bool is_one_strand(std::span<const StrandSegment> segments);

}  // namespace dapple
