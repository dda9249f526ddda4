// Sums over the pixels around each pixel.
#pragma once

#include <vector>

namespace dapple {

/// Of each pixel and its up to eight neighbours, of pictures `width` a row.
std::vector<float> neighbourhood_sums(const std::vector<float>& pixels, int width);

}  // namespace dapple
