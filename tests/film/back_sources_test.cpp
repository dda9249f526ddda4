// Pixels that stand in for others whose backs were not sampled.
#include "film/back_sources.hpp"

#include <gtest/gtest.h>

#include <set>

namespace dapple {
namespace {

TEST(BackSources, ArePixelsThemselvesOrTheNearestThatHaveSamplesWithinSixteenPixels) {
  constexpr std::uint32_t kWidth = 40, kPixels = 40 * 30;
  const auto at = [](std::uint32_t x, std::uint32_t y) { return y * kWidth + x; };
  const std::set<std::uint32_t> have{at(3, 4), at(9, 4), at(3, 25)};
  const auto has = [&](std::uint32_t p) { return have.contains(p); };
  const auto needs = [&](std::uint32_t p) { return !has(p) && p != at(4, 5); };
  const auto sources = back_sources(kPixels, kWidth, needs, has);
  EXPECT_EQ(sources.size(), kPixels);
  EXPECT_EQ(sources[at(3, 4)], at(3, 4));
  EXPECT_EQ(sources[at(4, 4)], at(3, 4));
  EXPECT_EQ(sources[at(4, 5)], at(4, 5));  // needs none
  EXPECT_EQ(sources[at(8, 6)], at(9, 4));
  EXPECT_EQ(sources[at(0, 0)], at(3, 4));
  EXPECT_EQ(sources[at(25, 4)], at(9, 4));
  EXPECT_EQ(sources[at(26, 4)], at(26, 4));  // seventeen pixels away
  EXPECT_EQ(sources[at(39, 29)], at(39, 29));
  EXPECT_EQ(sources[at(0, 29)], at(3, 25));
}

}  // namespace
}  // namespace dapple
