#include "render/queries/free_shifts.hpp"

#include <cstdint>

#include "dapple/render.hpp"
#include "device/upload/scene_upload.hpp"

namespace dapple {
namespace {

/// Rays that keep less meet something.
constexpr float kFree = 1 - 1e-3f;

Ray ray_along(const V3f& shift, const V3f& geometric, const SurfacePoint& point) {
  Ray ray{};
  const float length = shift.length();
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = point.position[axis] + point.offset * geometric[axis];
    ray.direction[axis] = shift[axis] / length;
  }
  ray.t_max = length;
  ray.weight = 1;
  return ray;
}

}  // namespace

std::vector<V3f> free_shifts(const Device& device, const DeviceScene& scene,
                             const QueryPoints& points) {
  std::vector<V3f> shifts(points.shifts.begin(), points.shifts.end());
  std::vector<std::uint32_t> moving;
  std::vector<Ray> rays;
  for (std::uint32_t i = 0; i < shifts.size(); ++i) {
    const V3f& geometric = points.geometric[i];
    if (!(geometric.length2() > 0) || !(shifts[i].length2() > 0)) continue;
    const SurfacePoint point = query_point(points, i, scene.buffers->params);
    if (!moves_outward(geometric, shifts[i], point)) continue;
    moving.push_back(i);
    rays.push_back(ray_along(shifts[i], geometric, point));
  }
  if (rays.empty()) return shifts;
  const std::vector<Occlusion> found = trace(device, scene, rays, Estimator::exact);
  for (std::size_t k = 0; k < moving.size(); ++k)
    if (found[k].transmittance < kFree) shifts[moving[k]] = V3f(0, 0, 0);
  return shifts;
}

}  // namespace dapple
