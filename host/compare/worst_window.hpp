// Finds where two pictures differ most: the window with the largest sum of squared differences, at
// any position, by a summed-area table (Crow, "Summed-Area Tables for Texture Mapping", 1984). In:
// squared differences. Out: the window and its sum.
#pragma once

#include <vector>

#include "dapple/options.hpp"

namespace dapple {

/// Maximum width and height of the window, in pixels; a smaller picture limits it.
inline constexpr int kWindowSide = 32;

struct WorstWindow {
  PixelRect rect;    ///< (0,0) is the first pixel given
  double sum = 0.0;  ///< of the given values inside `rect`
};

/// `squared` has width * height values, row-major, none negative. Among equal windows returns the
/// first in reading order. Sums have rounding errors of about 1e-16 of the whole picture's sum.
WorstWindow find_worst_window(std::vector<double> squared, int width, int height);

}  // namespace dapple
