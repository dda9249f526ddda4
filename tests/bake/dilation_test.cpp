// Dilation of baked textures: each texel within the margin takes the nearest valid one.
#include "bake/texture/dilation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace dapple {
namespace {

constexpr std::uint32_t kSize = 32;  // texels a side

std::vector<bool> valid_at(std::uint32_t a, std::uint32_t b) {
  std::vector<bool> valid(kSize * kSize);
  valid[a] = valid[b] = true;
  return valid;
}

TEST(Dilation, ATexelTakesTheNearestValidOneWithinTheMargin) {
  const std::uint32_t a = 10 * kSize + 10, b = 20 * kSize + 22;
  const std::vector<std::uint32_t> nearest = nearest_valid(valid_at(a, b), kSize, 5);
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const auto away = [&](std::uint32_t of) {
        return std::max(std::abs(static_cast<int>(x) - static_cast<int>(of % kSize)),
                        std::abs(static_cast<int>(y) - static_cast<int>(of / kSize)));
      };
      const std::uint32_t expected = away(a) <= 5 ? a : away(b) <= 5 ? b : kNoTexel;
      EXPECT_EQ(nearest[y * kSize + x], expected) << x << ", " << y;
    }
  }
}

TEST(Dilation, BetweenTwoValidTexelsEachTexelTakesTheCloserOne) {
  const std::uint32_t a = 16 * kSize + 12, b = 16 * kSize + 18;
  const std::vector<std::uint32_t> nearest = nearest_valid(valid_at(a, b), kSize, 10);
  int reached = 0;
  for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
    const auto square = [&](std::uint32_t of) {
      const int dx = static_cast<int>(i % kSize) - static_cast<int>(of % kSize);
      const int dy = static_cast<int>(i / kSize) - static_cast<int>(of / kSize);
      return dx * dx + dy * dy;
    };
    if (nearest[i] == kNoTexel) continue;
    ++reached;
    EXPECT_EQ(square(nearest[i]), std::min(square(a), square(b))) << i % kSize << ", " << i / kSize;
  }
  EXPECT_GE(reached, 21 * 21);
}

TEST(Dilation, TheSearchStaysInItsTexels) {
  constexpr std::uint32_t kSmall = 16;
  std::vector<bool> valid(kSmall * kSmall), within(kSmall * kSmall);
  const auto at = [](std::uint32_t x, std::uint32_t y) { return y * kSmall + x; };
  // Two columns with an empty one between them; the values are at the ends far from each other.
  for (std::uint32_t y = 0; y < kSmall; ++y) within[at(4, y)] = within[at(6, y)] = true;
  valid[at(4, 0)] = valid[at(6, 15)] = true;
  const std::vector<std::uint32_t> nearest = nearest_valid(valid, kSmall, 16, within);
  for (std::uint32_t y = 0; y < kSmall; ++y) {
    EXPECT_EQ(nearest[at(4, y)], at(4, 0)) << y;
    EXPECT_EQ(nearest[at(6, y)], at(6, 15)) << y;
    EXPECT_EQ(nearest[at(5, y)], kNoTexel) << y;
  }
}

}  // namespace
}  // namespace dapple
