// The order in which pixels are traced, and the blocks of pixels that get the same number of
// samples. Pixels that are traced together lie close together, so that ray packets are coherent.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dapple {

/// Side in pixels of the blocks that get the same number of samples, so that packets of few samples
/// a pixel stay coherent: experiment 507.
inline constexpr int kBlock = 2;

/// Indices of all pixels, tile by tile (8 x 8 pixels), and block by block in each tile.
std::vector<std::uint32_t> tile_order(int width, int height);

/// Calls `visit` with the pixels of the block whose corner is at `left`, `top`.
template <class Visit>
void visit_block(int left, int top, int width, int height, const Visit& visit) {
  for (int y = top; y < std::min(top + kBlock, height); ++y)
    for (int x = left; x < std::min(left + kBlock, width); ++x)
      visit(static_cast<std::uint32_t>(y * width + x));
}

/// Calls `visit` with the index of each block and each of its pixels. Blocks are visited in
/// parallel.
template <class Visit>
void visit_blocks(int width, std::size_t pixels, const Visit& visit) {
  const int height = static_cast<int>(pixels) / width, columns = (width + kBlock - 1) / kBlock;
  tbb::parallel_for(0, (height + kBlock - 1) / kBlock, [&](int row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t block = static_cast<std::size_t>(row) * columns + column;
      visit_block(column * kBlock, row * kBlock, width, height,
                  [&](std::uint32_t pixel) { visit(block, pixel); });
    }
  });
}

/// For each block the values of its pixels, joined two by two, beginning with T{}.
template <class T, class Join>
std::vector<T> by_block(const std::vector<T>& values, int width, const Join& join) {
  const std::size_t columns = (width + kBlock - 1) / kBlock;
  const std::size_t rows = (values.size() / width + kBlock - 1) / kBlock;
  std::vector<T> joined(columns * rows);
  visit_blocks(width, values.size(), [&](std::size_t block, std::uint32_t pixel) {
    joined[block] = join(joined[block], values[pixel]);
  });
  return joined;
}

}  // namespace dapple
