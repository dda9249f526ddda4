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

float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction) {
  const V3f c = opacity.normals.correlation();
  const auto sign = [](float x) { return std::copysign(1.0f, x); };
  const V3f& d = direction;
  const float depth =
      box_depth(depth_of(opacity.axes.x), depth_of(opacity.axes.y), depth_of(opacity.axes.z),
                c.x * sign(d.x * d.y), c.y * sign(d.y * d.z), c.z * sign(d.z * d.x),
                size.y * size.z * std::fabs(d.x), size.z * size.x * std::fabs(d.y),
                size.x * size.y * std::fabs(d.z));
  return 1.0f - std::exp(-depth);
}

}  // namespace dapple
