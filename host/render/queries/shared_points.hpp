// Points that queries start from, in memory that host and device share. In: positions and normals.
// Out: a buffer of SurfacePoint.
#pragma once

#include <span>
#include <vector>

#include "dapple/render.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/pass_params.h"
#include "dapple/shared/ray.h"
#include "device/context.hpp"

namespace dapple {

/// 64 roundings of a coordinate, as a part of it: callers round those of their points.
inline constexpr float kOriginOffset = 3.8e-6f;

/// A rounding of a term of QueryPoints::reaches counts as this part of one of a coordinate.
inline constexpr float kTermsOfReach = 1.0f / 8;

/// The largest terms of the sums that are the coordinates of points in the world: what these are
/// rounded to, also where the sums are small. `reach`: of the points' coordinates in object space,
/// not negative.
V3f reach_in_world(const V3f& reach, const M44f& to_world);

/// How far above a plane rays start whose origins are on it but for roundings of such terms.
float offset_above_plane(const V3f& reach, const V3f& normal);

/// Points from which rays start, in world space.
struct QueryPoints {
  std::span<const V3f> positions;
  std::span<const V3f> normals;  ///< unit vectors, around which directions are distributed
  /// Of smooth surfaces: the unit normals of the triangles, zero for flat ones; or empty.
  /// Directions below the triangle are hidden, unless the point moves by `shifts` to the smooth
  /// surface above.
  std::span<const V3f> geometric = {}, shifts = {};
  /// Whether `geometric`, and `normals` where it is zero, are those of the surfaces' planes.
  bool has_planes = false;
  /// The largest terms of the sums that were rounded to `positions`, not negative; or empty.
  std::span<const V3f> reaches = {};
  /// Unit normals of the surfaces that points lie on, off which rays start; empty: `normals`.
  /// Directions below these surfaces are not hidden.
  std::span<const V3f> surfaces = {};
};

/// Point `i`, not moved to its smooth surface; its rays start `offset` above it.
SurfacePoint query_point(const QueryPoints& points, std::uint32_t i, const SceneParams& scene);

/// Whether the point of a smooth surface moves to it: where that lies above its triangle by more
/// than rounding errors.
bool moves_outward(const V3f& geometric, const V3f& shift, const SurfacePoint& point);

/// Points in host memory that the device reads in place. The destructor waits for the device.
class SharedPoints {
 public:
  /// The points with the indices `chosen`, which also seed their random numbers. Rays in `scene`
  /// start above them by a bound on roundings.
  SharedPoints(DeviceContext& context, const QueryPoints& points,
               std::span<const std::uint32_t> chosen, const SceneParams& scene);
  ~SharedPoints() { context_.wait(); }
  SharedPoints(const SharedPoints&) = delete;
  SharedPoints& operator=(const SharedPoints&) = delete;

  [[nodiscard]] Buffer buffer() const {
    return context_.share(points_.data(), points_.size() * sizeof(SurfacePoint));
  }

 private:
  DeviceContext& context_;
  std::vector<SurfacePoint> points_;
};

/// Between two slices of the query `name`: reports that `done` of `all` points are finished. Throws
/// Error failed if the caller wants to stop.
void report_slice(const RenderControl& control, const char* name, std::size_t done,
                  std::size_t all);

}  // namespace dapple
