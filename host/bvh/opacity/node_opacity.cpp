#include "bvh/opacity/node_opacity.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
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
  // The rows of the matrix are the images of the axes; the rows of cofactors are their cross
  // products.
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

namespace {

/// A power of two by which the largest of these numbers, which are not negative, is from 1 to 2:
/// their ratios matter, and the squares of areas exceed a float. 1 if they are 0 or not finite.
float unit_of(float a, float b, float c) {
  const float most = std::max({a, b, c});
  return std::isnormal(most) ? std::ldexp(1.0f, -std::max(std::ilogb(most), -126)) : 1.0f;
}

}  // namespace

V3f NormalMoments::correlation() const {
  const float unit = unit_of(sum[0], sum[1], sum[2]);
  const auto of = [&](int pair, int i, int j) {
    const float product = (unit * sum[i]) * (unit * sum[j]);
    return product > 0.0f ? std::clamp(unit * sum[pair] / std::sqrt(product), -1.0f, 1.0f) : 0.0f;
  };
  return {of(3, 0, 1), of(4, 1, 2), of(5, 2, 0)};
}

namespace {

/// Values for four directions, in one 128-bit register.
using Four = float __attribute__((vector_size(16)));
using FourInts = int __attribute__((vector_size(16)));

Four all(float x) { return Four{x, x, x, x}; }
Four smallest(Four a, Four b) { return a < b ? a : b; }
Four largest(Four a, Four b) { return a > b ? a : b; }
Four magnitude(Four x) { return largest(x, -x); }
Four root(Four x) {
  return Four{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// Returns exp(-x) for x >= 0. The relative error is at most 4e-6 for x up to 16; x above 87 counts
/// as 87.
Four exp_of_minus(Four x) {
  const Four octaves = smallest(x, all(87.0f)) * std::numbers::log2e_v<float>;
  const FourInts whole = __builtin_convertvector(octaves + 0.5f, FourInts);
  // Taylor's series of 2^rest for rest in [-1/2, 1/2].
  const Four rest = __builtin_convertvector(whole, Four) - octaves;
  Four p = 1.3333558e-3f * rest + 9.6181291e-3f;
  p = p * rest + 5.5504109e-2f;
  p = p * rest + 2.4022651e-1f;
  p = p * rest + 6.9314718e-1f;
  p = p * rest + 1.0f;
  const FourInts power = (127 - whole) << 23;
  return p * std::bit_cast<Four>(power);
}

struct FourVectors {
  Four x, y, z;
};

/// chord_variance() for four directions.
Four chord_variances(const FourVectors& facing) {
  // The mean square follows from the covariogram of the box: the integral over the longest chord of
  // prod (1 - q_k s), where q_k is the share of side k that this chord spans.
  const Four longest = largest(largest(facing.x, facing.y), largest(facing.z, all(1e-37f)));
  const Four per = 1.0f / longest;
  const Four qx = facing.x * per, qy = facing.y * per, qz = facing.z * per;
  const Four e1 = qx + qy + qz, e2 = qx * qy + qy * qz + qz * qx, e3 = qx * qy * qz;
  return largest(all(0.0f),
                 2.0f * e1 * (1.0f - e1 * (1.0f / 2) + e2 * (1.0f / 3) - e3 * (1.0f / 4)) - 1.0f);
}

/// Returns the variances of the optical depths of rays by chord_depth() and centre_weight(),
/// divided by the squares of their means `depth`. Fitted to samples for boxes of any shape, with an
/// error of a tenth. Chords through the middle are the long ones. `tilt`: squared distance of the
/// mass pole times squared mass concentration; a third of its variance counts (experiment 225).
Four depth_variances(Four depth, Four chords, float mass_concentration, float tilt) {
  // The share of a chord's deviation from the mean chord that counts: chord_depth().
  constexpr float kPerDepth = 1.0f / (DAPPLE_FILLED_DEPTH - DAPPLE_SPARSE_DEPTH);
  const Four counted =
      smallest(largest((DAPPLE_FILLED_DEPTH - depth) * kPerDepth, all(0.0f)), all(1.0f));
  return chords * counted * counted * (1.0f + 1.3f * mass_concentration) +
         0.17f * mass_concentration * mass_concentration + 0.3f * tilt;
}

/// Returns the mean transmittances of rays whose depths have these means and relative variances and
/// follow a gamma distribution.
Four mean_transmittances(Four depth, Four variance) {
  // (1 + v depth)^(-1 / v), where log(1 + x) is approximated by x (6 + x) / (6 + 4 x): the error of
  // the transmittance is about a hundredth for x up to 2.
  const Four x = variance * depth;
  return exp_of_minus(depth * (6.0f + x) / (6.0f + 4.0f * x));
}

}  // namespace

unsigned variance_class(const NodeOpacity& opacity) {
  float greatest = 0, max_opacity = 0;
  for (int axis = 0; axis < 3; ++axis) {
    greatest += opacity.axes[axis] * (1.0f - opacity.axes[axis]);
    max_opacity = std::max(max_opacity, opacity.axes[axis]);
  }
  const float square = std::max(opacity.clumping * greatest / 3, std::pow(max_opacity, 4.0f));
  unsigned result_class = 0;
  for (float limit = DAPPLE_MIN_VARIANCE; result_class < DAPPLE_NOT_UNIFORM && !(square <= limit);
       limit *= 2)
    ++result_class;
  return result_class;
}

float depth_of(float opacity) {
  return -std::log(std::max(1.0f - opacity, DAPPLE_MIN_TRANSMITTANCE));
}

float chord_variance(const V3f& facing) {
  return chord_variances({all(facing.x), all(facing.y), all(facing.z)})[0];
}

float MassShape::mean_weight() const {
  // By sampled points and directions; by concentration, and by the number of axes along which the
  // pole is 3/4 away.
  constexpr float kMeans[4][4] = {{1, 1, 1, 1},
                                  {0.9932f, 0.9949f, 0.9995f, 1.0047f},
                                  {0.9996f, 1.0320f, 1.0612f, 1.0911f},
                                  {1.0324f, 1.1112f, 1.1681f, 1.2234f}};
  int far = 0;
  for (int axis = 0; axis < 3; ++axis) far += std::fabs(pole[axis]) > 0.5f ? 1 : 0;
  return kMeans[std::lround(3.0f * concentration)][far];
}

MassShape mass_shape_of(const V3f& centroid, float off_centre) {
  // Over a square, 1, x, y and 2/3 - x^2 - y^2 are orthogonal; the squares of the latter have these
  // means. An opacity of 1 + c (2/3 - x^2 - y^2) + 2 c pole . (x, y) has the centroid 2/3 c pole
  // and the off_centre 2/3 - 8/45 c.
  constexpr float kOfCentroid = 1.0f / 3.0f, kOfSquares = 8.0f / 45.0f;
  const float wanted = (2.0f / 3.0f - off_centre) / kOfSquares;
  const Four tilt = Four{centroid.x, centroid.y, centroid.z, 0.0f} / kOfCentroid;
  MassShape best;
  float least = std::numeric_limits<float>::max();
  for (int level = 0; level <= 3; ++level) {
    const float concentration = static_cast<float>(level) * (1.0f / 3.0f);
    const Four place = level ? tilt / concentration : Four{};
    // The nearest of -3/4, -1/4, 1/4 and 3/4: a comparison that is true is -1.
    const FourInts steps = (place >= -1.0f) + (place >= 0.0f) + (place >= 1.0f);
    const Four pole = -0.75f - 0.5f * __builtin_convertvector(steps, Four);
    const Four missed = tilt - 2.0f * concentration * pole;
    // An axis is seen in two of three views.
    const Four errors = 2.0f / 3.0f * kOfCentroid * missed * missed;
    const float error = kOfSquares * (concentration - wanted) * (concentration - wanted) +
                        errors[0] + errors[1] + errors[2];
    if (error < least) {
      least = error;
      best = {concentration, V3f(pole[0], pole[1], pole[2])};
    }
  }
  return best;
}

namespace {

/// The share of the opacity lost by mass concentration that is compensated. Neighbouring nodes
/// occlude the same rays more often than independent nodes would, so that the product of their
/// transmittances is right if each transmits slightly too much light (experiment 244).
constexpr float kCompensated = 0.7f;

/// Computes the opacity of a box from four directions at a time.
class DirectionalOpacity {
 public:
  DirectionalOpacity(const NodeOpacity& opacity, const V3f& size)
      : faces_(in_units(V3f(size.y * size.z, size.z * size.x, size.x * size.y))),
        axes_(opacity.axes),
        depths_(depth_of(axes_.x), depth_of(axes_.y), depth_of(axes_.z)),
        correlation_(opacity.normals.correlation()),
        clumping_(opacity.clumping),
        mass_concentration_(opacity.mass.concentration),
        compensated_(opacity.mass.concentration * kCompensated),
        tilt_(opacity.mass.concentration * opacity.mass.concentration *
              opacity.mass.pole.length2()) {}

  struct Views {
    Four facing;   ///< projected area of the box
    Four model;    ///< mean opacity of rays by the kernels' model
    Four slope;    ///< derivative of `model` by a factor on depths
    Four opacity;  ///< mean opacity that rays should have
  };

  [[nodiscard]] Views along(const FourVectors& direction) const {
    const FourVectors facing{faces_.x * magnitude(direction.x), faces_.y * magnitude(direction.y),
                             faces_.z * magnitude(direction.z)};
    const FourVectors seen{faces_.x * direction.x, faces_.y * direction.y, faces_.z * direction.z};
    const Four area = facing.x + facing.y + facing.z;
    const Four depth = blend(depths_, seen, area);
    const Four chords = chord_variances(facing);
    Views views = by_model(area, depth, chords);
    // Content in the middle of the box does not become less opaque because the corners of the box
    // are empty: mass concentration reduces the variance.
    const Four uniform =
        1.0f - mean_transmittances(depth, (1.0f - mass_concentration_) *
                                              depth_variances(depth, chords, 0.0f, 0.0f));
    const Four clump = smallest(blend(axes_, seen, area), all(1.0f));
    views.opacity = uniform + clumping_ * (clump - uniform);
    return views;
  }

  /// Views along the axes. Their opacities are known, and the chords of a view have equal lengths:
  /// the variance is 0. The fourth lane has area 0.
  [[nodiscard]] Views along_axes() const {
    Views views = by_model(Four{faces_.x, faces_.y, faces_.z, 0.0f},
                           Four{depths_.x, depths_.y, depths_.z, 0.0f}, all(0.0f));
    views.opacity = Four{axes_.x, axes_.y, axes_.z, 0.0f};
    return views;
  }

 private:
  static V3f in_units(const V3f& faces) { return faces * unit_of(faces.x, faces.y, faces.z); }

  /// Sets all members but `opacity`.
  [[nodiscard]] Views by_model(Four area, Four depth, Four chords) const {
    const Four variance = depth_variances(depth, chords, compensated_, tilt_);
    const Four transmittance = mean_transmittances(depth, variance);
    return {area, 1.0f - transmittance, depth * transmittance / (1.0f + variance * depth),
            all(0.0f)};
  }

  /// box_depth() of dapple/shared/opacity.h. There, correlations are multiplied by the signs of the
  /// direction; here, the areas `seen` have these signs.
  [[nodiscard]] Four blend(const V3f& axes, const FourVectors& seen, Four area) const {
    const Four x = axes.x * seen.x, y = axes.y * seen.y, z = axes.z * seen.z;
    const Four mixed = correlation_.x * x * y + correlation_.y * y * z + correlation_.z * z * x;
    return root(largest(x * x + y * y + z * z + 2.0f * mixed, all(0.0f))) / (area + 1e-37f);
  }

  V3f faces_;  ///< of the box; only their ratios matter
  V3f axes_, depths_, correlation_;
  float clumping_, mass_concentration_;
  float compensated_;  ///< mass concentration times kCompensated
  float tilt_;         ///< as in depth_variances()
};

}  // namespace

float opacity_along(const NodeOpacity& opacity, const V3f& size, const V3f& direction) {
  const FourVectors directions{all(direction.x), all(direction.y), all(direction.z)};
  return DirectionalOpacity(opacity, size).along(directions).opacity[0];
}

float clumping_factor(const NodeOpacity& opacity, const V3f& size) {
  const DirectionalOpacity directional(opacity, size);
  // The axes and the diagonals of a cube, weighted 2/15 and 3/20, integrate polynomials of
  // degree 5 over the sphere (Abramowitz and Stegun, 25.4.65).
  constexpr float kRoot = 0.57735027f;
  const auto axes = directional.along_axes();
  const auto diagonals = directional.along(FourVectors{Four{kRoot, kRoot, -kRoot, -kRoot},
                                                       Four{kRoot, -kRoot, kRoot, -kRoot},
                                                       Four{kRoot, -kRoot, -kRoot, kRoot}});
  const Four of_axes = 2.0f / 15 * axes.facing;
  const Four of_diagonals = 3.0f / 20 * diagonals.facing;
  // Occluded area summed over directions: the wanted area minus the area by the depths, and the
  // derivative of the latter by the factor.
  const Four wanted =
      of_axes * (axes.opacity - axes.model) + of_diagonals * (diagonals.opacity - diagonals.model);
  const Four changed = of_axes * axes.slope + of_diagonals * diagonals.slope;
  const float residual = wanted[0] + wanted[1] + wanted[2] + wanted[3];
  const float slope = changed[0] + changed[1] + changed[2] + changed[3];
  if (!(slope > 0.0f)) return 1.0f;
  return std::clamp(1.0f + residual / slope, 0.6f, 1.6f);
}

}  // namespace dapple
