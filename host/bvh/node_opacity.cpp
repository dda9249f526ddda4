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

/// Hidden area per direction of a single layer and of depths scaled by 1, the latter's
/// change with the scale, summed over directions.
struct HiddenArea {
  double layer = 0, depths = 0, slope = 0;
  void add(double weight, double facing, double single, double depth) {
    const double transmitted = std::exp(-depth);
    layer += weight * std::min(single, facing);
    depths += weight * facing * (1 - transmitted);
    slope += weight * facing * depth * transmitted;
  }
};

}  // namespace

float single_layer_factor(const NodeOpacity& opacity, const V3f& size) {
  if (opacity.triangles == 0 || opacity.triangles >= 64) return 1.0f;
  const float fading = 1.0f - std::log2(static_cast<float>(opacity.triangles)) / 6.0f;
  const V3f faces(size.y * size.z, size.z * size.x, size.x * size.y);
  const V3f depths(depth_of(opacity.axes.x), depth_of(opacity.axes.y), depth_of(opacity.axes.z));
  const V3f c = opacity.normals.correlation();
  HiddenArea hidden;
  // The axes and the diagonals of a cube, weighted to integrate polynomials of degree 5 over
  // the sphere (Abramowitz and Stegun, 25.4.65).
  for (int k = 0; k < 3; ++k) {
    hidden.add(2.0 / 15, faces[k], opacity.axes[k] * faces[k], depths[k]);
  }
  const float root = std::sqrt(1.0f / 3.0f);
  const V3f f = faces * root, area = opacity.axes * f;
  for (const V3f& s : {V3f(1, 1, 1), V3f(1, -1, -1), V3f(-1, 1, -1), V3f(-1, -1, 1)}) {
    // Signs of xy, yz, zx of the four diagonals.
    const V3f r = c * s;
    const float square = area.length2() + 2.0f * (r.x * area.x * area.y + r.y * area.y * area.z +
                                                  r.z * area.z * area.x);
    hidden.add(3.0 / 20, f.x + f.y + f.z, std::sqrt(std::max(square, 0.0f)),
               box_depth(depths.x, depths.y, depths.z, r.x, r.y, r.z, f.x, f.y, f.z));
  }
  if (!(hidden.slope > 0)) return 1.0f;
  const double factor = 1.0 + (hidden.layer - hidden.depths) / hidden.slope;
  return 1.0f + fading * static_cast<float>(std::clamp(factor, 0.75, 1.25) - 1.0);
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
