#include "wavefront/scouts.hpp"

#include <algorithm>
#include <random>

namespace dapple {
namespace {

/// Side of a square, and the least side of a cell, in pixels.
constexpr int kSquare = 4, kLeastCell = 8;

/// Squares that are enough: of those of a plant that fills a fifth of the picture the mean variance
/// is known to a tenth.
constexpr int kEnough = 256;

/// With fewer a picture's need is not known better than by a guess.
constexpr int kFewest = 64;

int squares_of(int width, int height, int cell) { return (width / cell) * (height / cell); }

/// The largest cell of which there are enough.
int cell_side(int width, int height) {
  int cell = kLeastCell;
  while (squares_of(width, height, 2 * cell) >= kEnough) cell *= 2;
  return cell;
}

}  // namespace

std::vector<bool> scout_pixels(int width, int height) {
  const int cell = cell_side(width, height);
  if (squares_of(width, height, cell) < kFewest) return {};
  std::vector<bool> scouts(static_cast<std::size_t>(width) * height, false);
  std::mt19937 random;  // the same everywhere
  const auto place = [&] { return static_cast<int>(random() % (cell / kSquare)) * kSquare; };
  for (int row = 0; row < height / cell; ++row) {
    for (int column = 0; column < width / cell; ++column) {
      const int left = column * cell + place(), top = row * cell + place();
      for (int y = top; y < top + kSquare; ++y) {
        const auto begin = scouts.begin() + static_cast<std::ptrdiff_t>(y) * width + left;
        std::fill_n(begin, kSquare, true);
      }
    }
  }
  return scouts;
}

}  // namespace dapple
