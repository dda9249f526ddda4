// Packs rectangles into a square texture, on shelves. In: sizes. Out: a common scale and the
// places.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {

/// Of a rectangle in a texture: its first texel and its size in texels.
struct TexelRect {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

struct Packing {
  float scale = 0;  ///< texels per unit of length
  std::vector<TexelRect> rects;
};

/// Packs rectangles with the largest scale for which they fit in `size` x `size` texels, with `gap`
/// texels between them. A rectangle has a texel more than its scaled size each way, so that
/// bilinear lookups inside it read no other. If they don't fit at any scale, the result is empty.
Packing pack(const std::vector<V2f>& sizes, std::uint32_t size, std::uint32_t gap);

/// The smallest size for which pack() succeeds.
std::uint32_t smallest_size(std::size_t rects, std::uint32_t gap);

}  // namespace dapple
