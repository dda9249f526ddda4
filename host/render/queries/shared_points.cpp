#include "render/queries/shared_points.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "dapple/error.hpp"
#include "dapple/shared/corner_normals.h"

namespace dapple {
namespace {

/// Rays start above a plane by the roundings of the coordinates along its normal, or of the terms
/// that these are the sums of, which may be larger; and by 16 roundings of the largest coordinate,
/// as above camera hits (surface_point.clh), where the plane is not known or matrices carry rays
/// into instances.
constexpr float kInAllDirections = 9.5e-7f;

SurfacePoint surface_point(const V3f& position, const V3f& normal, const V3f& plane,
                           const V3f& reach, std::size_t index, bool is_bounded) {
  SurfacePoint point{};
  float along = 0, largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    point.position[axis] = position[axis];
    point.normal[axis] = normal[axis];
    const float term = std::max(std::fabs(position[axis]), kTermsOfReach * reach[axis]);
    along += term * std::fabs(plane[axis]);
    largest = std::max(largest, term);
  }
  point.offset = along * kOriginOffset + (is_bounded ? 0.0f : largest * kInAllDirections);
  point.pixel = static_cast<uint>(index);
  return point;
}

/// Moves the point of a smooth surface to where its rays start: shade_point() of
/// smooth_point.clh, but for normals that face away: points have no viewer.
void smooth(const V3f& geometric, const V3f& shift, SurfacePoint& point) {
  const bool outward = moves_outward(geometric, shift, point);
  for (int axis = 0; axis < 3; ++axis)
    point.position[axis] += point.offset * geometric[axis] + (outward ? shift[axis] : 0.0f);
  point.offset = 0;
  if (!outward) point.t = std::bit_cast<float>(direction_code(&geometric.x));
}

}  // namespace

V3f reach_in_world(const V3f& reach, const M44f& to_world) {
  V3f sum(0, 0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 0; row < 3; ++row) sum[axis] += reach[row] * std::fabs(to_world[row][axis]);
    sum[axis] += std::fabs(to_world[3][axis]);
  }
  return sum;
}

float offset_above_plane(const V3f& reach, const V3f& normal) {
  float along = 0;
  for (int axis = 0; axis < 3; ++axis) along += reach[axis] * std::fabs(normal[axis]);
  return along * kTermsOfReach * kOriginOffset;
}

SurfacePoint query_point(const QueryPoints& points, std::uint32_t i, const SceneParams& scene) {
  const bool is_smooth = !points.geometric.empty() && points.geometric[i].length2() > 0;
  const V3f& plane = !points.surfaces.empty() ? points.surfaces[i]
                     : is_smooth              ? points.geometric[i]
                                              : points.normals[i];
  SurfacePoint point = surface_point(points.positions[i], points.normals[i], plane,
                                     points.reaches.empty() ? V3f(0, 0, 0) : points.reaches[i], i,
                                     points.has_planes && scene.has_top == 0);
  if (points.surfaces.empty()) return point;
  for (int axis = 0; axis < 3; ++axis) point.position[axis] += point.offset * plane[axis];
  point.offset = 0;
  return point;
}

bool moves_outward(const V3f& geometric, const V3f& shift, const SurfacePoint& point) {
  return geometric.dot(shift) > point.offset;
}

SharedPoints::SharedPoints(DeviceContext& context, const QueryPoints& points,
                           std::span<const std::uint32_t> chosen, const SceneParams& scene)
    : context_(context) {
  points_.resize(chosen.size());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t k) {
    const std::uint32_t i = chosen[k];
    points_[k] = query_point(points, i, scene);
    if (!points.geometric.empty() && points.geometric[i].length2() > 0)
      smooth(points.geometric[i], points.shifts[i], points_[k]);
  });
}

void report_slice(const RenderControl& control, const char* name, std::size_t done,
                  std::size_t all) {
  if (control.progress) control.progress(static_cast<double>(done) / static_cast<double>(all));
  if (control.stop && control.stop())
    throw Error(ErrorKind::failed,
                fmt::format("{}: stopped after {} of {} points", name, done, all));
}

}  // namespace dapple
