#include "bvh/opacity/welded_vertices.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace dapple {
namespace {

/// Steps of the grid, as powers of two. So few that corners which differ by a rounding error are on
/// two points in one of 128 coordinates at most: with 2^22 steps walls of such corners leaked. More
/// where the triangles are smaller than a step, as those of a house on a large terrain.
constexpr int kFewestSteps = 17, kMostSteps = 22;
constexpr std::size_t kSmallOnes = 20;  ///< one of so many triangles may be smaller than two steps

constexpr std::uint32_t kNone = ~0u;

float shortest_side(std::span<const V3f> positions, const std::uint32_t* corners) {
  const V3f &a = positions[corners[0]], &b = positions[corners[1]], &c = positions[corners[2]];
  return std::sqrt(std::min({(b - a).length2(), (c - b).length2(), (a - c).length2()}));
}

/// Of the grid over `extent` metres.
int power_of_steps(std::span<const V3f> positions, std::span<const std::uint32_t> indices,
                   float extent) {
  std::array<std::size_t, kMostSteps + 1> needing{};  // triangles, by the power that they need
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const float steps = 2 * extent / shortest_side(positions, &indices[i]);
    const int power = steps < 0x1p30f ? std::ilogb(std::max(steps, 1.0f)) + 1 : 0;  // 0: no area
    ++needing[static_cast<std::size_t>(std::min(power, kMostSteps))];
  }
  int power = kMostSteps;
  std::size_t small = 0;  // that need more
  const auto fewer = [&] { return small + needing[static_cast<std::size_t>(power)]; };
  while (power > kFewestSteps && fewer() * kSmallOnes <= indices.size() / 3) {
    small = fewer();
    --power;
  }
  return power;
}

/// Numbers of the grid's points. Of 64 bits: with 32, a fifth of the surfaces of 10 million
/// vertices would share one with another point.
std::vector<std::uint64_t> grid_points(std::span<const V3f> positions,
                                       std::span<const std::uint32_t> indices) {
  Box3f box;
  for (const V3f& position : positions) box.extendBy(position);
  float extent = 1e-30f;
  for (int axis = 0; axis < 3 && !positions.empty(); ++axis)
    extent = std::max({extent, box.max[axis] - box.min[axis], std::fabs(box.min[axis]),
                       std::fabs(box.max[axis])});
  const float scale = std::ldexp(1.0f, power_of_steps(positions, indices, extent)) / extent;
  std::vector<std::uint64_t> points(positions.size());
  std::transform(positions.begin(), positions.end(), points.begin(), [&](const V3f& position) {
    std::uint64_t point = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto step =
          static_cast<std::uint32_t>(std::lrint((position[axis] - box.min[axis]) * scale));
      point = (point ^ step) * 0x9e3779b97f4a7c15u;
      point ^= point >> 29;
    }
    return point;
  });
  return points;
}

}  // namespace

std::vector<std::uint32_t> welded_vertices(std::span<const V3f> positions,
                                           std::span<const std::uint32_t> indices) {
  const std::vector<std::uint64_t> points = grid_points(positions, indices);
  // An open-addressing hash table of the first vertices.
  const std::size_t mask = std::bit_ceil(2 * points.size() + 1) - 1;
  std::vector<std::uint32_t> table(mask + 1, kNone), welded(points.size());
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    std::size_t at = (points[v] >> 16) & mask;
    while (table[at] != kNone && points[table[at]] != points[v]) at = (at + 1) & mask;
    if (table[at] == kNone) table[at] = v;
    welded[v] = table[at];
  }
  return welded;
}

}  // namespace dapple
