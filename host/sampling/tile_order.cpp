#include "sampling/tile_order.hpp"

namespace dapple {
namespace {

/// Side of a tile in pixels: its 64 camera rays are coherent.
constexpr int kTile = 8;

/// Writes the pixels of the tiles whose first row is `top` to `next`.
void list_tiles(int top, int width, int height, std::uint32_t* next) {
  const int bottom = std::min(top + kTile, height);
  for (int left = 0; left < width; left += kTile)
    for (int y = top; y < bottom; y += kBlock)
      for (int x = left; x < std::min(left + kTile, width); x += kBlock)
        visit_block(x, y, width, height, [&](std::uint32_t pixel) { *next++ = pixel; });
}

}  // namespace

std::vector<std::uint32_t> tile_order(int width, int height) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(width) * height);
  tbb::parallel_for(0, (height + kTile - 1) / kTile, [&](int row) {
    const int top = row * kTile;
    list_tiles(top, width, height, order.data() + static_cast<std::size_t>(top) * width);
  });
  return order;
}

}  // namespace dapple
