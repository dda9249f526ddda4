#include "bvh/opacity/strand_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple {
namespace {

/// Tolerance, relative to a segment's length, for ends that were the same point before they were
/// rounded in blocks.
constexpr float kSamePoint = 1e-3f;

/// How far a strip extends beyond the centre of a cap, in radii: its area grows by that of half a
/// disk.
constexpr float kCapReach = static_cast<float>(std::numbers::pi / 4);

/// Whether the segments share an end point.
bool are_joined(const StrandSegment& a, const StrandSegment& b) {
  const float tolerance = kSamePoint * (b.point[1] - b.point[0]).length();
  for (const V3f& p : a.point) {
    for (const V3f& q : b.point) {
      if (p.equalWithAbsError(q, tolerance)) return true;
    }
  }
  return false;
}

}  // namespace

std::array<CoveringTriangle, 2> facing_strip(const StrandSegment& segment, int axis) {
  V3f view(0.0f);
  view[axis] = 1.0f;
  const V3f along = segment.point[1] - segment.point[0];
  V3f across = view.cross(along);
  if (!(across.length2() > 0.0f)) across[column_axis(axis)] = 1.0f;  // seen from its end
  across.normalize();
  const V3f onwards = across.cross(view);
  V3f point[2], half[2];
  for (int end = 0; end < 2; ++end) {
    const float radius = segment.radius[end];
    half[end] = across * radius;
    const float reach = segment.cap[end] ? kCapReach * radius : 0.0f;
    point[end] = segment.point[end] + onwards * (end ? reach : -reach);
  }
  const V3f corner = point[0] - half[0];
  const V3f diagonal = point[1] + half[1] - corner;
  return {CoveringTriangle{corner, 2.0f * half[0], diagonal, segment.opacity},
          CoveringTriangle{corner, diagonal, point[1] - half[1] - corner, segment.opacity}};
}

void add_surface(const StrandSegment& segment, NormalMoments& normals, SurfaceAreas& areas) {
  const V3f along = segment.point[1] - segment.point[0];
  const float width = segment.radius[0] + segment.radius[1];
  normals.add_cylinder(along, 0.5f * width, segment.opacity);
  V3f occluded;
  for (int axis = 0; axis < 3; ++axis) {
    occluded[axis] = width * std::hypot(along[column_axis(axis)], along[row_axis(axis)]);
    for (int end = 0; end < 2; ++end) {
      const float radius = segment.radius[end];
      occluded[axis] += segment.cap[end] ? 2 * kCapReach * radius * radius : 0.0f;
    }
  }
  areas.add(occluded, segment.opacity, false);
}

bool is_one_strand(std::span<const StrandSegment> segments) {
  for (std::size_t s = 1; s < segments.size(); ++s) {
    const auto before = segments.first(s);
    const auto is_joined = [&](const StrandSegment& other) {
      return are_joined(other, segments[s]);
    };
    if (std::none_of(before.begin(), before.end(), is_joined)) return false;
  }
  return true;
}

}  // namespace dapple
