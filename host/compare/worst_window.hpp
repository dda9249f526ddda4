// Where two pictures differ most: the window with the largest sum of squared differences,
// at any position, by a summed-area table (Crow 1984).
#pragma once

#include <vector>

#include "dapple/options.hpp"

namespace dapple {

/// Side of the window, in pixels; smaller where the picture is.
inline constexpr int kWindowSide = 32;

struct WorstWindow {
  PixelRect rect;    ///< (0,0) is the first pixel given
  double sum = 0.0;  ///< of what was given, inside `rect`
};

/// `squared` is row-major, width * height values, none negative. The first window in reading
/// order among equals. Sums are rounded to about 1e-16 of the whole picture's.
WorstWindow find_worst_window(std::vector<double> squared, int width, int height);

}  // namespace dapple
