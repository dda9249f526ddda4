#include "render/shared_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// The offset along the normal exceeds the rounding error of float coordinates.
SurfacePoint surface_point(const V3f& position, const V3f& normal, std::size_t index) {
  SurfacePoint point{};
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    point.position[axis] = position[axis];
    point.normal[axis] = normal[axis];
    largest = std::max(largest, std::fabs(position[axis]));
  }
  point.offset = largest * 4e-6f;
  point.pixel = static_cast<uint>(index);
  return point;
}

}  // namespace

SharedPoints::SharedPoints(DeviceContext& context, std::span<const V3f> points,
                           std::span<const V3f> normals, std::span<const std::uint32_t> chosen)
    : context_(context) {
  points_.reserve(chosen.size());
  for (const std::uint32_t i : chosen) points_.push_back(surface_point(points[i], normals[i], i));
}

void report_slice(const RenderControl& control, const char* name, std::size_t done,
                  std::size_t all) {
  if (control.progress) control.progress(static_cast<double>(done) / static_cast<double>(all));
  if (control.stop && control.stop())
    throw Error(ErrorKind::failed,
                fmt::format("{}: stopped after {} of {} points", name, done, all));
}

}  // namespace dapple
