#include "bvh/node_opacity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dapple/shared/opacity.h"

namespace dapple {

void NormalMoments::add(const V3f& normal, float opacity) {
  const float length = normal.length();
  if (!(length > 0.0f)) return;
  const V3f n = normal * (opacity / length);
  const float terms[6] = {n.x * normal.x, n.y * normal.y, n.z * normal.z,
                          n.x * normal.y, n.y * normal.z, n.z * normal.x};
  for (int i = 0; i < 6; ++i) sum[i] += terms[i];
}

void NormalMoments::add_cylinder(const V3f& axis, float radius, float opacity) {
  const float length = axis.length();
  if (!(length > 0.0f)) return;
  const V3f t = axis / length;
  // The mean of n n^T around the axis is (1 - t t^T) / 2; half of the side is pi r l.
  const float weight = 0.5f * static_cast<float>(std::numbers::pi) * radius * length * opacity;
  const float terms[6] = {1.0f - t.x * t.x, 1.0f - t.y * t.y, 1.0f - t.z * t.z,
                          -t.x * t.y,       -t.y * t.z,       -t.z * t.x};
  for (int i = 0; i < 6; ++i) sum[i] += weight * terms[i];
}

void NormalMoments::add(const NormalMoments& other) {
  for (int i = 0; i < 6; ++i) sum[i] += other.sum[i];
}

NormalMoments NormalMoments::placed(const M44f& to_world) const {
  // Rows are the images of the axes; cofactor rows are their cross products.
  V3f axis[3];
  for (int i = 0; i < 3; ++i) axis[i] = V3f(to_world[i][0], to_world[i][1], to_world[i][2]);
  const V3f cofactor[3] = {axis[1].cross(axis[2]), axis[2].cross(axis[0]), axis[0].cross(axis[1])};
  const float m[3][3] = {
      {sum[0], sum[3], sum[5]}, {sum[3], sum[1], sum[4]}, {sum[5], sum[4], sum[2]}};
  const auto turned = [&](int a, int b) {
    float value = 0.0f;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) value += cofactor[i][a] * m[i][j] * cofactor[j][b];
    }
    return value;
  };
  NormalMoments out;
  out.sum = {turned(0, 0), turned(1, 1), turned(2, 2), turned(0, 1), turned(1, 2), turned(2, 0)};
  return out;
}

V3f NormalMoments::correlation() const {
  const auto of = [&](int pair, int i, int j) {
    const float product = sum[i] * sum[j];
    return product > 0.0f ? std::clamp(sum[pair] / std::sqrt(product), -1.0f, 1.0f) : 0.0f;
  };
  return {of(3, 0, 1), of(4, 1, 2), of(5, 2, 0)};
}

float depth_of(float opacity) {
  return -std::log(std::max(1.0f - opacity, DAPPLE_LEAST_TRANSMITTANCE));
}

float chord_variance(const V3f& facing) {
  // Mean square by the box's covariogram, the integral over the longest chord of
  // prod (1 - q_k s); q_k is the share of side k that this chord spans.
  const V3f q = facing / std::max({facing.x, facing.y, facing.z, 1e-37f});
  const float e1 = q.x + q.y + q.z, e2 = q.x * q.y + q.y * q.z + q.z * q.x, e3 = q.x * q.y * q.z;
  return std::max(0.0f, 2.0f * e1 * (1.0f - e1 / 2.0f + e2 / 3.0f - e3 / 4.0f) - 1.0f);
}

float concentration_of(float off_centre) {
  // Where opacity falls as 1 + c (2/3 - r), r has mean 2/3 - c times its variance over a square.
  constexpr float kVariance = 8.0f / 45.0f;
  return std::clamp((2.0f / 3.0f - off_centre) / kVariance, 0.0f, 1.0f);
}

namespace {

/// Variance of the depths that chord_depth() and centre_weight() give rays, over the square of
/// their mean `depth`. Sampled for boxes of any shape, to a tenth: long chords are those through
/// the middle.
float depth_variance(float depth, const V3f& facing, float concentration) {
  if (!(depth > 0.0f)) return 0.0f;
  const float counted = chord_depth(depth, 2.0f) / depth - 1.0f;  // of a chord's deviation
  const float chords = chord_variance(facing) * counted * counted;
  return chords * (1.0f + 1.3f * concentration) + 0.17f * concentration * concentration;
}

/// Of rays whose depths have this mean and variance, as if gamma distributed.
float mean_transmittance(float depth, float variance) {
  // (1 + v depth)^(-1 / v), with log(1 + x) as x (6 + x) / (6 + 4 x), to a hundredth up to 2.
  const float x = variance * depth;
  return std::exp(-depth * (6.0f + x) / (6.0f + 4.0f * x));
}

/// How much of what concentration takes from the mean opacity is given back: all in nodes of
/// many triangles. Neighbouring small nodes hide the same rays more than independent ones would,
/// and a little too much light in each sets their product right (measured on trees).
float compensation(std::size_t triangles) {
  if (triangles == 0) return 1.0f;
  return std::clamp(std::log2(static_cast<float>(triangles) + 1.0f) / 12.0f, 0.0f, 1.0f);
}

/// Looks at a box of some size from any direction.
class DirectionalOpacity {
 public:
  DirectionalOpacity(const NodeOpacity& opacity, const V3f& size)
      : faces_(size.y * size.z, size.z * size.x, size.x * size.y),
        axes_(opacity.axes),
        depths_(depth_of(axes_.x), depth_of(axes_.y), depth_of(axes_.z)),
        correlation_(opacity.normals.correlation()),
        clumping_(opacity.clumping),
        concentration_(opacity.concentration),
        compensated_(opacity.concentration * compensation(opacity.triangles)) {}

  struct View {
    float facing;   ///< projected area of the box
    float met;      ///< mean opacity that rays meet
    float slope;    ///< its change with a factor on depths
    float opacity;  ///< that they should meet
  };

  [[nodiscard]] View along(const V3f& direction) const {
    V3f facing, correlation;
    for (int axis = 0; axis < 3; ++axis) {
      facing[axis] = faces_[axis] * std::fabs(direction[axis]);
      correlation[axis] =
          correlation_[axis] * std::copysign(1.0f, direction[axis] * direction[(axis + 1) % 3]);
    }
    const auto blend = [&](const V3f& axes) {
      return box_depth(axes.x, axes.y, axes.z, correlation.x, correlation.y, correlation.z,
                       facing.x, facing.y, facing.z);
    };
    const float depth = blend(depths_);
    View view = meet(facing, depth);
    // What gathers around the middle is no less opaque for the box's empty corners.
    const float even = 1.0f - mean_transmittance(depth, (1.0f - concentration_) *
                                                            depth_variance(depth, facing, 0.0f));
    view.opacity = even + clumping_ * (std::min(1.0f, blend(axes_)) - even);
    return view;
  }

  /// Along an axis, where the opacity is known.
  [[nodiscard]] View along_axis(int axis) const {
    V3f facing(0.0f);
    facing[axis] = faces_[axis];
    View view = meet(facing, depths_[axis]);
    view.opacity = axes_[axis];
    return view;
  }

 private:
  [[nodiscard]] View meet(const V3f& facing, float depth) const {
    const float variance = depth_variance(depth, facing, compensated_);
    const float transmittance = mean_transmittance(depth, variance);
    return {facing.x + facing.y + facing.z, 1.0f - transmittance,
            depth * transmittance / (1.0f + variance * depth), 0.0f};
  }

  V3f faces_, axes_, depths_, correlation_;
  float clumping_, concentration_;
  float compensated_;  ///< the concentration that is made up for
};

}  // namespace

float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction) {
  return DirectionalOpacity(opacity, size).along(direction).opacity;
}

float clumping_factor(const NodeOpacity& opacity, const V3f& size) {
  const DirectionalOpacity directional(opacity, size);
  // Hidden area summed over directions: what is wanted beyond what the depths give, and how
  // the latter changes with the factor.
  float wanting = 0, slope = 0;
  const auto add = [&](float weight, const DirectionalOpacity::View& view) {
    wanting += weight * view.facing * (view.opacity - view.met);
    slope += weight * view.facing * view.slope;
  };
  // The axes and the diagonals of a cube, weighted 2/15 and 3/20, integrate polynomials of
  // degree 5 over the sphere (Abramowitz and Stegun, 25.4.65).
  for (int axis = 0; axis < 3; ++axis) add(2.0f / 15, directional.along_axis(axis));
  const float root = std::sqrt(1.0f / 3.0f);
  for (const V3f& signs : {V3f(1, 1, 1), V3f(1, -1, -1), V3f(-1, 1, -1), V3f(-1, -1, 1)}) {
    add(3.0f / 20, directional.along(signs * root));
  }
  if (!(slope > 0.0f)) return 1.0f;
  return std::clamp(1.0f + wanting / slope, 0.6f, 1.6f);
}

}  // namespace dapple
