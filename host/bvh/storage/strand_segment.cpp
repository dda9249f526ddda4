#include "bvh/storage/strand_segment.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

/// If a strand turns by more than a right angle (a cosine below this), its segments end in planes
/// perpendicular to their axes: the plane that halves the angle would make a long spike.
constexpr float kMinTurnCosine = 0.0f;

/// Maximum change of radius, relative to length, for which neighbouring cones fit together well
/// enough at a plane.
constexpr float kMaxTaper = 0.5f;

V3f axis_of(const Mesh& mesh, std::uint32_t index) {
  const std::uint32_t* at = &mesh.indices[2 * std::size_t{index}];
  return (mesh.positions[at[1]] - mesh.positions[at[0]]).normalized();
}

float taper_of(const StrandSegment& segment) {
  const float length = (segment.point[1] - segment.point[0]).length();
  return std::fabs(segment.radius[1] - segment.radius[0]) / std::max(length, 1e-30f);
}

/// Returns half the size, along each axis, of the ellipse in which the plane cuts a cylinder of
/// radius 1.
V3f reach_of_cut(const V3f& axis, const V3f& plane) {
  const V3f slope = plane / plane.dot(axis) - axis;  // perpendicular to the axis
  V3f reach;
  for (int k = 0; k < 3; ++k) {
    V3f across = axis * -axis[k];
    across[k] += 1.0f;
    reach[k] = (across - slope * axis[k]).length();
  }
  return reach;
}

}  // namespace

Box3f bounds(const StrandSegment& segment) {
  const V3f axis = (segment.point[1] - segment.point[0]).normalized();
  const float taper = std::min(taper_of(segment), kMaxTaper);
  Box3f box;
  for (int end = 0; end < 2; ++end) {
    const V3f& plane = segment.plane[end];
    // A mitred end extends beyond the end of the axis, where the cone may be wider.
    const float radius = segment.radius[end] / (1.0f - taper);
    const bool cut = !segment.cap[end] && plane.dot(axis) > 0.0f;
    const V3f reach = (cut ? reach_of_cut(axis, plane) : V3f(1.0f)) * radius;
    box.extendBy(segment.point[end] - reach);
    box.extendBy(segment.point[end] + reach);
  }
  return box;
}

StrandJoints::StrandJoints(const Mesh& mesh) : at_vertex_(mesh.positions.size(), {kNone, kNone}) {
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    auto& there = at_vertex_[mesh.indices[i]];
    const auto segment = static_cast<std::uint32_t>(i / 2);
    if (there[0] == kNone) {
      there[0] = segment;
    } else {
      there[1] = there[1] == kNone ? segment : kMany;
    }
  }
}

std::uint32_t StrandJoints::neighbour(const Mesh& mesh, std::uint32_t index, int end) const {
  const auto& there = at_vertex_[mesh.indices[2 * std::size_t{index} + end]];
  if (there[1] == kMany) return kMany;
  return there[0] == index ? there[1] : there[0];
}

StrandSegment StrandJoints::segment(const Mesh& mesh, std::uint32_t index) const {
  StrandSegment segment;
  const std::uint32_t* at = &mesh.indices[2 * std::size_t{index}];
  const V3f axis = axis_of(mesh, index);
  for (int end = 0; end < 2; ++end) {
    segment.point[end] = mesh.positions[at[end]];
    segment.radius[end] = mesh.radii[at[end]];
    segment.plane[end] = axis;
  }
  const bool flares = taper_of(segment) > kMaxTaper;
  for (int end = 0; end < 2; ++end) {
    const std::uint32_t other = neighbour(mesh, index, end);
    segment.cap[end] = other == kNone;
    if (segment.cap[end] || other == kMany || flares) continue;
    // The axis of the neighbour, reversed if necessary to have the same direction along the strand.
    const bool same_way = mesh.indices[2 * std::size_t{other} + (1 - end)] == at[end];
    const V3f along = axis_of(mesh, other) * (same_way ? 1.0f : -1.0f);
    if (axis.dot(along) > kMinTurnCosine) segment.plane[end] = axis + along;
  }
  return segment;
}

}  // namespace dapple
