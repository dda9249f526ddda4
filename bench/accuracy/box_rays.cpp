#include "accuracy/box_rays.hpp"

#include <algorithm>
#include <cmath>

namespace dapple::bench {
namespace {

/// Axis of the face by which a ray enters the box, with a probability proportional to the projected
/// areas. `choice` is random, [0,1).
int choose_face(const V3f& facing, double choice) {
  const double at = choice * (facing.x + facing.y + facing.z);
  return at < facing.x ? 0 : at < facing.x + facing.y ? 1 : 2;
}

float length_inside(const Box3f& box, const V3f& from, const V3f& direction) {
  float leave = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0f) continue;
    const float side = direction[axis] > 0.0f ? box.max[axis] : box.min[axis];
    leave = std::min(leave, (side - from[axis]) / direction[axis]);
  }
  return std::max(leave, 0.0f);
}

}  // namespace

V3f facing_areas(const V3f& size, const V3f& direction) {
  return {size.y * size.z * std::fabs(direction.x), size.x * size.z * std::fabs(direction.y),
          size.x * size.y * std::fabs(direction.z)};
}

BoxRay ray_through(const Box3f& box, const V3f& direction, oracle::Random& random) {
  const V3f size = box.size();
  const V3f facing = facing_areas(size, direction);
  const int face = choose_face(facing, random.real());
  V3f entry;
  for (int axis = 0; axis < 3; ++axis) {
    entry[axis] = axis == face ? (direction[axis] > 0.0f ? box.min[axis] : box.max[axis])
                               : box.min[axis] + size[axis] * static_cast<float>(random.real());
  }
  const float mean_length = size.x * size.y * size.z / (facing.x + facing.y + facing.z);
  // The whole subtree lies inside the box, so rays may start outside.
  const V3f origin = entry - direction * (0.01f * size.length());
  const float length = length_inside(box, entry, direction);
  const V3f middle = (entry + direction * (0.5f * length) - box.center()) / (size * 0.5f);
  return {{origin, direction}, length / mean_length, middle};
}

SampledOpacity sample_opacity(const Truth& subtree, const Box3f& box, const V3f& direction,
                              int rays, oracle::Random& random) {
  SampledOpacity sampled{{}, 0, 0};
  double sum = 0, squares = 0;
  for (int i = 0; i < rays; ++i) {
    sampled.rays.push_back(ray_through(box, direction, random));
    const double opacity = 1 - subtree(sampled.rays.back().segment);
    sum += opacity;
    squares += opacity * opacity;
  }
  sampled.opacity = sum / rays;
  sampled.variance = (squares / rays - sampled.opacity * sampled.opacity) / (rays - 1);
  return sampled;
}

}  // namespace dapple::bench
