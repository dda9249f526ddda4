// Pilot pixels: sampled before all others to estimate how many samples a picture needs (on the bias
// of reusing such samples: Kirk and Arvo, "Unbiased Sampling Techniques for Image Synthesis",
// 1991).
#pragma once

#include <vector>

namespace dapple {

/// For each pixel, row by row, whether it is a pilot pixel. Pilot pixels are squares of 4x4, one at
/// a random position in each cell of a grid: at least 64 squares, mostly some hundreds; empty for
/// smaller pictures.
std::vector<bool> pilot_pixels(int width, int height);

}  // namespace dapple
