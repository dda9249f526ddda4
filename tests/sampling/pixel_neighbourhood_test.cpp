// Compares sums over neighbourhoods of 3x3 pixels with adding up the pixels one by one.
#include "sampling/pixel_neighbourhood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace dapple {
namespace {

float value_of(std::size_t pixel) { return static_cast<float>(pixel * 37 % 101); }

float sum_around(int x, int y, int width, int height) {
  float sum = 0;
  for (int row = std::max(0, y - 1); row <= std::min(height - 1, y + 1); ++row)
    for (int column = std::max(0, x - 1); column <= std::min(width - 1, x + 1); ++column)
      sum += value_of(static_cast<std::size_t>(row) * width + column);
  return sum;
}

TEST(PixelNeighbourhood, HasThePixelAndThoseBesideItInPicturesOfAnyShape) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 40}, {40, 1}, {2, 3}, {17, 33}, {5, 16}}) {
    const std::size_t pixels = static_cast<std::size_t>(width) * height;
    std::vector<int> visits(pixels);
    visit_neighbourhoods(
        pixels, width,
        [](std::size_t p) {
          return std::array<float, 2>{value_of(p), 1.0f};
        },
        [&](std::size_t p, const std::array<float, 2>& own, const std::array<float, 2>& around) {
          const int x = static_cast<int>(p) % width, y = static_cast<int>(p) / width;
          ++visits[p];
          float one_by_one = 0;
          for_each_neighbour(p, pixels, width,
                             [&](std::size_t neighbour) { one_by_one += value_of(neighbour); });
          EXPECT_EQ(one_by_one, around[0]) << x << ", " << y;
          EXPECT_EQ(own[0], value_of(p));
          EXPECT_EQ(around[0], sum_around(x, y, width, height)) << x << ", " << y;
          const int columns = std::min(x + 1, width - 1) - std::max(x - 1, 0) + 1;
          const int rows = std::min(y + 1, height - 1) - std::max(y - 1, 0) + 1;
          EXPECT_EQ(around[1], static_cast<float>(columns * rows));
        });
    EXPECT_EQ(visits, std::vector<int>(pixels, 1));
  }
}

}  // namespace
}  // namespace dapple
