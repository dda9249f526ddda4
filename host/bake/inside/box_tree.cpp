#include "bake/inside/box_tree.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace dapple {
namespace {

/// Bits of a Morton code along each axis.
constexpr unsigned kMortonBits = 10;

/// The lowest kMortonBits bits of x, each followed by two zeros.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

std::uint32_t morton_code(const V3f& point, const Box3f& bounds) {
  constexpr float kCells = 1u << kMortonBits;
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float size = bounds.max[axis] - bounds.min[axis];
    const float share = size > 0 ? (point[axis] - bounds.min[axis]) / size : 0.0f;
    const float cell = std::clamp(share * kCells, 0.0f, kCells - 1);
    code |= spread_bits(static_cast<std::uint32_t>(cell)) << axis;
  }
  return code;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box3f>& boxes) : order_(boxes.size()) {
  if (boxes.empty()) return;
  Box3f bounds;
  for (const Box3f& box : boxes) bounds.extendBy(box);
  std::vector<std::uint64_t> codes(boxes.size());  // and indices, so that all differ
  tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t i) {
    codes[i] = std::uint64_t{morton_code(boxes[i].center(), bounds)} << 32 | i;
  });
  tbb::parallel_sort(codes.begin(), codes.end());
  std::vector<Box3f> level(boxes.size());
  tbb::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t i) {
    order_[i] = static_cast<std::uint32_t>(codes[i]);
    level[i] = boxes[order_[i]];
  });
  levels_.push_back(std::move(level));
  while (levels_.back().size() > kWidth) {
    const std::vector<Box3f>& below = levels_.back();
    std::vector<Box3f> above((below.size() + kWidth - 1) / kWidth);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / kWidth].extendBy(below[i]);
    levels_.push_back(std::move(above));
  }
}

}  // namespace dapple
