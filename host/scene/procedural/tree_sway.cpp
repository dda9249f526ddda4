// Bends a tree from the foot to the tips: see tree_sway.hpp. Double arithmetic, rounded at the end:
// differences in libm's last bit do not change the mesh.
#include "scene/procedural/tree_sway.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/procedural/pcg32.hpp"

namespace dapple {
namespace {

using Imath::Quatd;
using Imath::V3d;

constexpr double kBend = 1.1;        // radians per tree height, for the thinnest limb
constexpr double kFlutter = 0.22;    // radians
constexpr double kMaxFlutter = 0.6;  // radians; with larger angles leaves would seem to spin
constexpr std::uint64_t kFlutterStreams = std::uint64_t{1} << 41;  // above the leaves' streams

/// A wave that travels through the crown.
struct Gust {
  double hertz;
  V3d waves;  ///< wave vector, radians per tree height
  double phase;
};

double at(const Gust& gust, const V3d& position, double seconds) {
  return std::sin(2 * std::numbers::pi * gust.hertz * seconds - gust.waves.dot(position) +
                  gust.phase);
}

/// The force on a limb at `position` (in tree heights). Slow gusts act on thick and thin limbs, the
/// quick one mainly on thin limbs. `thinness` is 0 for the trunk's foot and up to 1.
V3d wind_force(const V3d& position, double thinness, const Wind& wind) {
  static const Gust kAlong[] = {{0.17, {1.3, 0.2, 0.4}, 0.0}, {0.43, {2.9, 0.5, 1.1}, 1.9}};
  static const Gust kAcross[] = {{0.29, {1.7, 0.9, 1.5}, 4.1}, {0.71, {3.7, 1.3, 2.3}, 0.7}};
  static const Gust kQuick = {1.31, {7.9, 3.1, 6.1}, 2.7};
  const double quick = 0.25 * thinness * at(kQuick, position, wind.seconds);
  const double along = 0.55 + 0.3 * at(kAlong[0], position, wind.seconds) +
                       0.15 * at(kAlong[1], position, wind.seconds) + quick;
  const double across = 0.25 * at(kAcross[0], position, wind.seconds) +
                        0.15 * at(kAcross[1], position, wind.seconds) + quick;
  return V3d(along, 0, across) * wind.strength;
}

/// The rotation of a rotation vector: its direction is the axis, its length the angle in radians.
Quatd turn_by(const V3d& rotation) {
  const double angle = rotation.length();
  if (angle < 1e-12) return {};
  const double sine = std::sin(angle / 2) / angle;
  return {std::cos(angle / 2), rotation * sine};
}

V3d rotated(const Quatd& turn, const V3d& v) {
  const V3d twice = turn.v.cross(v) * 2.0;
  return v + twice * turn.r + turn.v.cross(twice);
}

}  // namespace

SwayingSkeleton::SwayingSkeleton(const TreeSkeleton& rest, float height_m, const Wind& wind)
    : rest_(rest), positions_(rest.size()), rotations_(rest.size()) {
  positions_[0] = V3d(rest.positions[0]);
  for (std::size_t node = 1; node < rest.size(); ++node) {
    const std::uint32_t parent = rest.parents[node];
    const V3d limb = V3d(rest.positions[node]) - V3d(rest.positions[parent]);
    const V3d now = rotated(rotations_[parent], limb);
    // A limb is stiff where it is thick and bends where it is thin. The wind turns it towards the
    // direction of the force; a limb that already points there does not turn.
    const double thinness =
        std::clamp(1.0 - double{rest.radii[node]} / double{rest.radii[0]}, 0.0, 1.0);
    const double give = kBend * (0.06 + 0.94 * thinness * thinness) / double{height_m};
    const V3d force = wind_force(V3d(rest.positions[node]) / double{height_m}, thinness, wind);
    rotations_[node] = (turn_by(now.cross(force) * give) * rotations_[parent]).normalized();
    positions_[node] = positions_[parent] + rotated(rotations_[node], limb);
  }
}

V3f SwayingSkeleton::moved(std::uint32_t node, V3f rest) const {
  return V3f(positions_[node] + rotated(rotations_[node], V3d(rest) - V3d(rest_.positions[node])));
}

V3f SwayingSkeleton::turned(std::uint32_t node, V3f rest) const {
  return V3f(rotated(rotations_[node], V3d(rest)).normalized());
}

Blade flutter(const Blade& blade, const Wind& wind, std::uint32_t seed, std::uint32_t leaf) {
  Pcg32 rng(seed, kFlutterStreams + leaf);
  const auto wave = [&](double min_hertz, double max_hertz) {
    const double hertz = min_hertz + (max_hertz - min_hertz) * double{rng.unit()};
    const double phase = double{rng.unit()};
    return std::sin(2 * std::numbers::pi * (hertz * wind.seconds + phase));
  };
  const double amplitude = std::min(kFlutter * wind.strength, kMaxFlutter);
  const double twist = amplitude * wave(1.1, 2.3), nod = 0.6 * amplitude * wave(0.7, 1.7);
  const V3d axis(blade.axis), side = axis.cross(V3d(blade.normal));
  const Quatd turn = turn_by(side * nod) * turn_by(axis * twist);
  Blade turned = blade;
  turned.axis = V3f(rotated(turn, axis).normalized());
  const V3d normal = rotated(turn, V3d(blade.normal));
  turned.normal = V3f((normal - V3d(turned.axis) * normal.dot(V3d(turned.axis))).normalized());
  return turned;
}

}  // namespace dapple
