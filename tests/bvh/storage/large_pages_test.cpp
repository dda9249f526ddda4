// Memory in large pages: where it begins, and that vectors in it behave as others do.
#include "bvh/storage/large_pages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "dapple/const_array.hpp"

namespace dapple {
namespace {

constexpr std::size_t kPage = std::size_t{1} << 21;

TEST(LargePages, LargeArraysBeginAtAPage) {
  for (const std::size_t bytes : {4 * kPage + 4, 5 * kPage + 4, 33 * kPage}) {
    const LargeVector<std::uint32_t> values(bytes / 4);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % kPage, 0u) << bytes;
  }
}

TEST(LargePages, VectorsGrowCopyAndMoveThroughEverySize) {
  LargeVector<std::uint32_t> grown;
  std::vector<std::uint32_t> expected(5 * kPage / 4);
  std::iota(expected.begin(), expected.end(), 7u);
  for (const std::uint32_t value : expected) grown.push_back(value);
  const LargeVector<std::uint32_t> copy = grown;
  EXPECT_TRUE(std::equal(copy.begin(), copy.end(), expected.begin(), expected.end()));

  const std::uint32_t* memory = grown.data();
  const ConstArray<std::uint32_t> shared = std::move(grown);
  EXPECT_EQ(shared.data(), memory) << "copied";
  EXPECT_EQ(shared.size(), expected.size());
  EXPECT_EQ(shared.back(), expected.back());
}

}  // namespace
}  // namespace dapple
