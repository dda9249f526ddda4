#include "bake/texture/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dapple {
namespace {

constexpr int kBisections = 24;

/// Number of texels along a side of a scaled rectangle; too many for any texture if it is huge.
std::uint32_t texels(float length, float scale) {
  return static_cast<std::uint32_t>(std::min(std::ceil(length * scale), 1e6f)) + 1;
}

/// Places rectangles in the given order on shelves as high as their first one. False: no room.
bool shelve(const std::vector<V2f>& sizes, const std::vector<std::uint32_t>& order, float scale,
            std::uint32_t size, std::uint32_t gap, std::vector<TexelRect>* rects) {
  std::uint32_t x = 0, y = 0, shelf = 0;
  for (const std::uint32_t i : order) {
    const std::uint32_t width = texels(sizes[i].x, scale), height = texels(sizes[i].y, scale);
    if (x + width > size) {
      x = 0;
      y += shelf + gap;
      shelf = 0;
    }
    if (width > size || y + height > size) return false;
    if (rects) (*rects)[i] = {x, y, width, height};
    x += width + gap;
    shelf = std::max(shelf, height);
  }
  return true;
}

}  // namespace

Packing pack(const std::vector<V2f>& sizes, std::uint32_t size, std::uint32_t gap) {
  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return sizes[a].y != sizes[b].y ? sizes[a].y > sizes[b].y : sizes[a].x > sizes[b].x;
  });
  if (!shelve(sizes, order, 0, size, gap, nullptr)) return {};
  float largest = 1e-30f;
  for (const V2f& s : sizes) largest = std::max(largest, s.x);
  float low = 0, high = static_cast<float>(size) / largest;
  for (int i = 0; i < kBisections; ++i) {
    const float middle = 0.5f * (low + high);
    (shelve(sizes, order, middle, size, gap, nullptr) ? low : high) = middle;
  }
  if (!(low > 0)) return {};  // there is room for points only
  Packing packing{low, std::vector<TexelRect>(sizes.size())};
  shelve(sizes, order, low, size, gap, &packing.rects);
  return packing;
}

std::uint32_t smallest_size(std::size_t rects, std::uint32_t gap) {
  std::uint32_t size = 2;
  const auto fits = [&] {
    const std::size_t row = (size + gap) / (2 + gap);  // a side of any length touches two texels
    return row * row >= rects;
  };
  while (!fits()) ++size;
  return size;
}

}  // namespace dapple
