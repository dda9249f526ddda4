#include "bvh/node_opacity.hpp"

#include <algorithm>
#include <cmath>

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

namespace {

/// The two ways of blending along one direction, as opacities, and what they were made of.
struct DirectionalOpacity {
  float facing;   ///< projected area of the box
  float depth;    ///< depths blended
  float opacity;  ///< between that depth's and the blended areas', by clumping
};

DirectionalOpacity look_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction) {
  const V3f correlation = opacity.normals.correlation();
  V3f facing, signed_correlation;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    facing[axis] = size[next] * size[last] * std::fabs(direction[axis]);
    signed_correlation[axis] =
        correlation[axis] * std::copysign(1.0f, direction[axis] * direction[next]);
  }
  const auto blend = [&](const V3f& axes) {
    return box_depth(axes.x, axes.y, axes.z, signed_correlation.x, signed_correlation.y,
                     signed_correlation.z, facing.x, facing.y, facing.z);
  };
  DirectionalOpacity along;
  along.facing = facing.x + facing.y + facing.z;
  along.depth =
      blend({depth_of(opacity.axes.x), depth_of(opacity.axes.y), depth_of(opacity.axes.z)});
  const float even = 1.0f - std::exp(-along.depth), clump = std::min(1.0f, blend(opacity.axes));
  along.opacity = even + opacity.clumping * (clump - even);
  return along;
}

}  // namespace

float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction) {
  return look_along(opacity, size, direction).opacity;
}

float clumping_factor(const NodeOpacity& opacity, const V3f& size) {
  // Hidden area summed over directions: what is wanted beyond what the depths give, and how
  // the latter changes with the factor.
  double wanting = 0, slope = 0;
  const auto add = [&](double weight, const V3f& direction) {
    const DirectionalOpacity along = look_along(opacity, size, direction);
    const double transmitted = std::exp(-along.depth);
    wanting += weight * along.facing * (along.opacity - (1 - transmitted));
    slope += weight * along.facing * along.depth * transmitted;
  };
  // The axes, where both agree, and the diagonals of a cube integrate polynomials of degree 5
  // over the sphere (Abramowitz and Stegun, 25.4.65): weights 2/15 and 3/20.
  for (int axis = 0; axis < 3; ++axis) {
    V3f direction(0.0f);
    direction[axis] = 1.0f;
    add(2.0 / 15, direction);
  }
  const float root = std::sqrt(1.0f / 3.0f);
  for (const V3f& signs : {V3f(1, 1, 1), V3f(1, -1, -1), V3f(-1, 1, -1), V3f(-1, -1, 1)}) {
    add(3.0 / 20, signs * root);
  }
  if (!(slope > 0)) return 1.0f;
  return static_cast<float>(std::clamp(1.0 + wanting / slope, 0.75, 1.25));
}

}  // namespace dapple
