// Texels beside the border of a texture. In: an index, and how the texture goes on. Out: the texel
// that is seen there.
#pragma once

#include <algorithm>

#include "dapple/scene.hpp"

namespace dapple {

/// Along one side of `size` texels.
inline int wrapped_texel(int texel, int size, Wrap mode) {
  if (texel >= 0 && texel < size) return texel;
  if (mode == Wrap::clamp) return std::clamp(texel, 0, size - 1);
  const int period = mode == Wrap::mirror ? 2 * size : size;
  int r = texel % period;
  if (r < 0) r += period;
  return r < size ? r : period - 1 - r;
}

}  // namespace dapple
