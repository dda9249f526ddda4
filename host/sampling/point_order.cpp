#include "sampling/point_order.hpp"

#include <algorithm>
#include <array>

namespace dapple {
namespace {

constexpr int kAxisBits = 10, kDigitBits = 10;
constexpr float kSteps = 1 << kAxisBits;  ///< along each axis

/// Index of a point, and its Morton code: the position along the curve.
struct CodedPoint {
  std::uint32_t code;
  std::uint32_t index;
};

/// Spreads the lower 10 bits: two zeros are inserted above each.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

std::vector<CodedPoint> code_points(std::span<const V3f> points) {
  Box3f box;
  for (const V3f& point : points) box.extendBy(point);
  V3f scale(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    const float size = box.max[axis] - box.min[axis];
    if (size > 0.0f) scale[axis] = kSteps / size;
  }
  std::vector<CodedPoint> coded(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const V3f at = (points[i] - box.min) * scale;
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // NaN gets the largest code.
      const float step = at[axis] < kSteps - 1 ? std::max(at[axis], 0.0f) : kSteps - 1;
      code |= spread_bits(static_cast<std::uint32_t>(step)) << axis;
    }
    coded[i] = {code, static_cast<std::uint32_t>(i)};
  }
  return coded;
}

/// A stable radix sort; sorting by comparisons is slower (experiment 602) but for a few points.
void sort_by_code(std::vector<CodedPoint>& points) {
  constexpr std::uint32_t kDigits = 1u << kDigitBits;
  if (points.size() < kDigits / 4) {
    std::stable_sort(points.begin(), points.end(),
                     [](const CodedPoint& a, const CodedPoint& b) { return a.code < b.code; });
    return;
  }
  std::vector<CodedPoint> sorted(points.size());
  for (int shift = 0; shift < 3 * kAxisBits; shift += kDigitBits) {
    const auto digit = [shift](const CodedPoint& p) { return p.code >> shift & (kDigits - 1); };
    std::array<std::uint32_t, kDigits + 1> start{};
    for (const CodedPoint& point : points) ++start[digit(point) + 1];
    for (std::uint32_t i = 0; i < kDigits; ++i) start[i + 1] += start[i];
    for (const CodedPoint& point : points) sorted[start[digit(point)]++] = point;
    points.swap(sorted);
  }
}

}  // namespace

std::vector<std::uint32_t> order_along_curve(std::span<const V3f> points) {
  std::vector<CodedPoint> coded = code_points(points);
  sort_by_code(coded);
  std::vector<std::uint32_t> order(points.size());
  std::transform(coded.begin(), coded.end(), order.begin(),
                 [](const CodedPoint& point) { return point.index; });
  return order;
}

}  // namespace dapple
