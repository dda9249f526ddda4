// Pixels that are sampled before all others, to tell how many samples a picture needs.
#pragma once

#include <vector>

namespace dapple {

enum class PilotPass {
  all,
  first_pass,  ///< a quarter of them: those of every other cell of every other row
};

/// For each pixel, row by row, whether it is one: squares of 4x4, whose packets are as narrow as in
/// a whole picture, one in every cell of a grid but at another place in each. At least 64 squares
/// and mostly some hundreds; empty where a picture has room for fewer.
std::vector<bool> pilot_pixels(int width, int height, PilotPass which = PilotPass::all);

}  // namespace dapple
