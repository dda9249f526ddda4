#include "sampling/pilot_samples.hpp"

#include <algorithm>
#include <bit>
#include <random>

namespace dapple {
namespace {

/// Side of a square, and of the smallest cells, in pixels.
constexpr int kSquare = 4, kSmallCell = 8, kCell = 12;

/// Number of squares that is enough to know the mean variance (experiment 504). In pictures with
/// fewer a ninth of all pixels, or a quarter in small pictures, are pilot pixels.
constexpr int kEnough = 256;

/// With fewer squares there is no pilot.
constexpr int kFewest = 64;

int squares_of(int width, int height, int cell) { return (width / cell) * (height / cell); }

/// The largest cell of 12, 16, 24, 32, 48... pixels of which the picture has enough.
int cell_side(int width, int height) {
  int cell = squares_of(width, height, kCell) >= kFewest ? kCell : kSmallCell;
  for (int next = 16; squares_of(width, height, next) >= kEnough;
       next = std::has_single_bit(static_cast<unsigned>(next)) ? next * 3 / 2 : next * 4 / 3)
    cell = next;
  return cell;
}

}  // namespace

std::vector<bool> pilot_pixels(int width, int height) {
  const int cell = cell_side(width, height);
  if (squares_of(width, height, cell) < kFewest) return {};
  std::vector<bool> pilot(static_cast<std::size_t>(width) * height, false);
  std::mt19937 random;  // the same everywhere
  const auto offset = [&] { return static_cast<int>(random() % (cell / kSquare)) * kSquare; };
  for (int row = 0; row < height / cell; ++row) {
    for (int column = 0; column < width / cell; ++column) {
      const int left = column * cell + offset(), top = row * cell + offset();
      for (int y = top; y < top + kSquare; ++y) {
        const auto begin = pilot.begin() + static_cast<std::ptrdiff_t>(y) * width + left;
        std::fill_n(begin, kSquare, true);
      }
    }
  }
  return pilot;
}

}  // namespace dapple
