#include "rivals/embree/light_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dapple::bench {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A unit vector, uniform in the cone around a unit axis; `one_minus_cos` is that of the cone's
/// half angle (Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
V3f cone_direction(const V3f& axis, float one_minus_cos, float x, float y) {
  const float height = x * one_minus_cos, angle = 2 * kPi * y;
  const float radius = std::sqrt(std::max(0.0f, height * (2 - height)));
  const float s = std::copysign(1.0f, axis.z), a = -1 / (s + axis.z), b = axis.x * axis.y * a;
  const V3f tangent(1 + s * axis.x * axis.x * a, s * b, -s * axis.x);
  const V3f bitangent(b, s + axis.y * axis.y * a, -axis.y);
  return (tangent * (radius * std::cos(angle)) + bitangent * (radius * std::sin(angle)) +
          axis * (1 - height))
      .normalized();
}

/// The falloff of KHR_lights_punctual between the cones of a spot.
float spot_share(const Light& light, const V3f& axis) {
  if (light.cos_outer <= -1) return 1;
  const float inside = -axis.dot(light.direction) - light.cos_outer;
  const float edge =
      std::clamp(inside / std::max(1e-7f, light.cos_inner - light.cos_outer), 0.0f, 1.0f);
  return edge * edge;
}

/// Uniform in the cone of directions to the sphere; from inside, uniform over all directions.
LightSample sample_sphere(const Light& light, const V3f& origin, float x, float y) {
  const V3f way = light.position - origin;
  const float distance = way.length(), radius = light.radius;
  const bool inside = distance <= radius;
  const V3f axis = distance > 0 ? way * (1 / distance) : V3f(0, 1, 0);
  const float sine = radius / std::max(distance, radius);
  const float cone = inside ? 2 : sine * sine / (1 + std::sqrt(std::max(0.0f, 1 - sine * sine)));
  const V3f direction = cone_direction(axis, cone, x, y);
  const float along = direction.dot(way);
  const float half_chord =
      std::sqrt(std::max(0.0f, radius * radius - (distance * distance - along * along)));
  return {direction, inside ? along + half_chord : along - half_chord,
          2 * kPi * cone * spot_share(light, axis)};
}

LightSample sample_sun(const Light& light, float x, float y) {
  const float half = std::sin(0.5f * light.angular_radius), cone = 2 * half * half;
  return {cone_direction(-light.direction, cone, x, y), std::numeric_limits<float>::infinity(),
          2 * kPi * cone};
}

}  // namespace

bool can_sample(const Light& light) {
  return light.kind == LightKind::rect || light.kind == LightKind::sphere ||
         light.kind == LightKind::sun;
}

LightSampler::LightSampler(const Light& light) : light_(light) {
  if (light.kind != LightKind::rect) return;
  const bool u_is_shorter = light.edge_u.length2() <= light.edge_v.length2();
  const V3f x_edge = u_is_shorter ? light.edge_u : light.edge_v;
  const V3f y_edge = u_is_shorter ? light.edge_v : light.edge_u;
  width_ = x_edge.length();
  length_ = y_edge.length();
  x_axis_ = x_edge / width_;
  y_axis_ = y_edge / length_;
  corner_ = light.position - (x_edge + y_edge) * 0.5f;
}

// rect_point() of kernels/lights/rect_sample.clh. The angle that the shorter edge takes, and the
// point at a part of it, by the addition theorems of the arc tangent and of the tangent.
LightSample LightSampler::sample_rect(const V3f& origin, float u, float v) const {
  const V3f& facing = light_.direction;
  const V3f corner = corner_ - origin;
  const float left = corner.dot(x_axis_), low = corner.dot(y_axis_), high = low + length_;
  const float height = -corner.dot(facing), beside = std::max({low, -high, 0.0f});
  const float near_square = height * height + beside * beside + 1e-30f;
  const float near = std::sqrt(near_square);
  const float angle = std::atan2(width_ * near, near_square + left * (left + width_));
  const float slope = std::tan(u * angle);
  const float x = near * (left + near * slope) / (near - left * slope);
  const float line_square = height * height + x * x + 1e-30f;
  const float first = low / std::sqrt(line_square + low * low);
  const float range = high / std::sqrt(line_square + high * high) - first;
  const float across = first + v * range;
  const float y = across * std::sqrt(line_square / std::max(1 - across * across, 1e-7f));
  const V3f way = x_axis_ * x + y_axis_ * y - facing * height;
  const float distance = std::max(way.length(), 1e-10f);
  const float weight =
      std::max(height, 0.0f) * angle * range * (near_square + x * x) / (near * line_square);
  return {way / distance, distance, weight};
}

LightSample LightSampler::operator()(const V3f& origin, float x, float y) const {
  switch (light_.kind) {
    case LightKind::rect:
      return sample_rect(origin, x, y);
    case LightKind::sphere:
      return sample_sphere(light_, origin, x, y);
    case LightKind::sun:
    case LightKind::mesh:
    case LightKind::dome:
    case LightKind::disk:
      break;
  }
  return sample_sun(light_, x, y);
}

}  // namespace dapple::bench
