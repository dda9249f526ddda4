#include "bvh/opacity/welded_vertices.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dapple {
namespace {

/// Of the grid. So few that corners which differ by a rounding error are on two points in one of
/// 128 coordinates at most: with 2^22 steps walls of such corners leaked.
constexpr float kGridSteps = 131072.0f;

constexpr std::uint32_t kNone = ~0u;

/// The point of the grid as one number: no axis has more than 2^18 steps.
std::vector<std::uint64_t> grid_points(std::span<const V3f> positions) {
  Box3f box;
  for (const V3f& position : positions) box.extendBy(position);
  float extent = 1e-30f;
  for (int axis = 0; axis < 3 && !positions.empty(); ++axis)
    extent = std::max({extent, box.max[axis] - box.min[axis], std::fabs(box.min[axis]),
                       std::fabs(box.max[axis])});
  const float scale = kGridSteps / extent;
  std::vector<std::uint64_t> points(positions.size());
  std::transform(positions.begin(), positions.end(), points.begin(), [&](const V3f& position) {
    std::uint64_t point = 0;
    for (int axis = 0; axis < 3; ++axis)
      point = point << 18 |
              static_cast<std::uint32_t>(std::lrint((position[axis] - box.min[axis]) * scale));
    return point;
  });
  return points;
}

}  // namespace

std::vector<std::uint32_t> welded_vertices(std::span<const V3f> positions) {
  const std::vector<std::uint64_t> points = grid_points(positions);
  // An open-addressing hash table of the first vertices.
  const std::size_t mask = std::bit_ceil(2 * points.size() + 1) - 1;
  std::vector<std::uint32_t> table(mask + 1, kNone), welded(points.size());
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    std::size_t at = (points[v] * 0x9e3779b97f4a7c15u >> 24) & mask;
    while (table[at] != kNone && points[table[at]] != points[v]) at = (at + 1) & mask;
    if (table[at] == kNone) table[at] = v;
    welded[v] = table[at];
  }
  return welded;
}

}  // namespace dapple
