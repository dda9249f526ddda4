// Coverage of strands. In: segments of strands. Out: their outlines along an axis, as strips that
// face the axis, and their normals and projected areas.
#pragma once

#include <array>
#include <span>

#include "bvh/opacity/closed_surface.hpp"
#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "bvh/storage/strand_segment.hpp"

namespace dapple {

/// Returns the outline of the segment seen along `axis`: two triangles that share an edge and are
/// perpendicular to the axis.
std::array<CoveringTriangle, 2> facing_strip(const StrandSegment& segment, int axis);

/// Adds the normals and the projected areas of the segment.
void add_surface(const StrandSegment& segment, NormalMoments& normals, SurfaceAreas& areas);

/// Whether each segment of a leaf, except the first, shares an end with an earlier one. Segments
/// that are connected end to end hardly occlude each other.
bool is_one_strand(std::span<const StrandSegment> segments);

}  // namespace dapple
