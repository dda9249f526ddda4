#include "wavefront/point_order.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>

namespace dapple {
namespace {

constexpr float kSteps = 1024;  ///< along each axis

/// The lower 10 bits, two zeros above each.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

}  // namespace

std::vector<std::uint32_t> order_along_curve(std::span<const V3f> points) {
  Box3f box;
  for (const V3f& point : points) box.extendBy(point);
  V3f scale(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const float size = box.max[axis] - box.min[axis];
    if (size > 0.0f) scale[axis] = kSteps / size;
  }
  // By place, then by index.
  std::vector<std::uint64_t> keys(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    const V3f at = (points[i] - box.min) * scale;
    std::uint32_t place = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // NaN, which no order suits, goes to the end.
      const float step = at[axis] < kSteps - 1 ? std::max(at[axis], 0.0f) : kSteps - 1;
      place |= spread_bits(static_cast<std::uint32_t>(step)) << axis;
    }
    keys[i] = std::uint64_t{place} << 32 | i;
  });
  tbb::parallel_sort(keys);
  std::vector<std::uint32_t> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(),
                 [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
  return order;
}

}  // namespace dapple
