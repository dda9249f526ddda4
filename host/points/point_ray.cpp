#include "points/point_ray.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/queries/shared_points.hpp"

namespace dapple {

Ray point_ray(const V3f& point, const V3f& normal, const V3f& direction, float solid_angle,
              std::uint32_t key) {
  Ray ray{};
  const float start =
      std::max({std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)}) * kOriginOffset;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = point[axis] + normal[axis] * start;
    ray.direction[axis] = direction[axis];
  }
  ray.t_max = std::numeric_limits<float>::infinity();
  ray.solid_angle = solid_angle;
  ray.key = key;
  return ray;
}

}  // namespace dapple
