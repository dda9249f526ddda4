// Divides a picture into tiles of 8x8 pixels, the units of work of the threads. In: the picture's
// size. Out: tiles with their pixels along a Z curve (Morton 1966), so that packets hold adjacent
// pixels.
#pragma once

#include <cstdint>
#include <vector>

namespace dapple::bench {

inline constexpr int kTileWidth = 8;
inline constexpr unsigned kTilePixels = kTileWidth * kTileWidth;

struct PixelTile {
  unsigned count = 0;                 ///< fewer than kTilePixels at the picture's edge
  std::uint32_t pixels[kTilePixels];  ///< row * width + column
};

/// The even bits of a number below 64, compacted.
inline int even_bits(unsigned x) {
  return static_cast<int>((x & 1u) | (x >> 1 & 2u) | (x >> 2 & 4u));
}

inline std::vector<PixelTile> pixel_tiles(int width, int height) {
  std::vector<PixelTile> tiles;
  for (int top = 0; top < height; top += kTileWidth) {
    for (int left = 0; left < width; left += kTileWidth) {
      PixelTile& tile = tiles.emplace_back();
      for (unsigned i = 0; i < kTilePixels; ++i) {
        const int column = left + even_bits(i), row = top + even_bits(i >> 1);
        if (column < width && row < height)
          tile.pixels[tile.count++] = static_cast<std::uint32_t>(row * width + column);
      }
    }
  }
  return tiles;
}

}  // namespace dapple::bench
