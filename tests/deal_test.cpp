// Work-items are dealt out so that each part of a queue is taken once, neighbours far apart in
// time.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

std::vector<uint> dealt(uint count) {
  const Buffer places = device().allocate(count * sizeof(uint));
  run("deal", "deal_items", count, {places, count, count});
  return download<uint>(places, count);
}

/// Of all items that are launched for `count`: whole runs.
std::vector<uint> dealt_in_runs(uint count, uint length) {
  const uint items = (count + length - 1) / length * length;
  const Buffer places = device().allocate(items * sizeof(uint));
  run("deal", "deal_items_in_runs", items, {places, items, count, length});
  return download<uint>(places, items);
}

std::vector<uint> all_below(std::size_t count) {
  std::vector<uint> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

TEST(Deal, EveryPlaceComesOnce) {
  for (uint count = 1; count <= 70; ++count) {
    std::vector<uint> places = dealt(count);
    std::sort(places.begin(), places.end());
    EXPECT_EQ(places, all_below(count)) << count;
  }
}

TEST(Deal, EightInARowComeFromAsManyParts) {
  constexpr uint kCount = 800, kPart = kCount / 8;
  const std::vector<uint> places = dealt(kCount);
  for (uint item = 0; item < kCount; ++item) EXPECT_EQ(places[item] / kPart, item % 8) << item;
}

TEST(Deal, RunsStayTogetherAndEveryPlaceComesOnce) {
  constexpr uint kRun = 16;
  for (const uint count : {1u, 15u, 16u, 17u, 127u, 128u, 129u, 145u, 1000u, 2048u}) {
    std::vector<uint> places = dealt_in_runs(count, kRun);
    for (std::size_t item = 0; item < places.size(); ++item)
      EXPECT_EQ(places[item], places[item / kRun * kRun] + item % kRun) << count << ": " << item;
    std::sort(places.begin(), places.end());
    EXPECT_EQ(places, all_below(places.size())) << count;
  }
}

}  // namespace
}  // namespace dapple
