// Functions of kernels/vectors/lanes.clh and kernels/occlusion/ray_sets.clh in each way in which
// they can be compiled: conversion of lanes to bits and back, nodes that a packet pushes, sets of
// rays by lane, and rounding.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "dapple/shared/bvh_node.h"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

class Lanes : public testing::TestWithParam<const char*> {};

TEST_P(Lanes, BitFunctionsAreRightForEveryPattern) {
  constexpr uint kPatterns = 65536, kValues = 6;
  const Buffer results = device().allocate(kPatterns * kValues * sizeof(uint));
  run(GetParam(), "lanes_of_patterns", kPatterns, {results});
  const auto found = download<uint>(results, kPatterns * kValues);
  for (uint pattern = 0; pattern < kPatterns; ++pattern) {
    const uint lowest = pattern ? static_cast<uint>(std::countr_zero(pattern)) : 16u;
    const std::vector<uint> expected{pattern,           pattern, (pattern & 255u) != 0,
                                     pattern >> 8 != 0, pattern, lowest};
    const auto* at = &found[kValues * pattern];
    ASSERT_EQ(std::vector<uint>(at, at + kValues), expected) << "pattern " << pattern;
  }
}

TEST_P(Lanes, OpenedNodesArePushedInOrderAndLeavesAreNot) {
  constexpr uint kPatterns = 65536, kValues = 17;
  const Buffer nodes = device().allocate(kPatterns * sizeof(BvhNode));
  const Buffer results = device().allocate(kPatterns * kValues * sizeof(uint));
  run(GetParam(), "children_of_patterns", kPatterns, {nodes, results});
  const auto found = download<uint>(results, kPatterns * kValues);
  for (uint pattern = 0; pattern < kPatterns; ++pattern) {
    std::vector<uint> expected(kValues);
    uint next = 100;
    for (uint slot = 0; slot < 8; ++slot) {
      const bool inner = pattern >> slot & 1, opened = pattern >> (8 + slot) & 1;
      if (inner && opened) {
        const uint index = expected[0]++;
        expected[1 + index] = next;
        expected[9 + index] = slot + 1;
      }
      next += inner;
    }
    const auto* at = &found[kValues * pattern];
    ASSERT_EQ(std::vector<uint>(at, at + kValues), expected) << "pattern " << pattern;
  }
}

TEST_P(Lanes, SetsOfRaysAreThoseOfWords) {
  constexpr uint kItems = 256, kLanes = 8, kValues = 49;
  std::mt19937_64 random(1);
  std::vector<std::uint64_t> sets(2 * kLanes * kItems);
  for (std::uint64_t& set : sets) set = random() & random() & (random() % 4 ? ~0ull : 0ull);
  const Buffer in = upload(sets), out = device().allocate(kItems * kValues * sizeof(sets[0]));
  run(GetParam(), "sets_of_rays", kItems, {in, out});
  const auto found = download<std::uint64_t>(out, kItems * kValues);
  for (uint item = 0; item < kItems; ++item) {
    std::vector<std::uint64_t> expected(kValues);
    for (uint lane = 0; lane < kLanes; ++lane) {
      const std::uint64_t some = sets[2 * kLanes * item + lane];
      const std::uint64_t others = sets[2 * kLanes * item + kLanes + lane];
      expected[lane] = some;
      expected[8 + lane] = some >> item % 64 & 1 ? ~0ull : 0;
      expected[16 + lane] = some ? ~0ull : 0;
      expected[24 + lane] = item >> lane & 1 ? some : 0;
      expected[32 + lane] = some & ~others;
      expected[40 + lane] = some & others;
      expected[48] |= some;
    }
    const auto* at = &found[kValues * item];
    ASSERT_EQ(std::vector<std::uint64_t>(at, at + kValues), expected) << "item " << item;
  }
}

TEST_P(Lanes, RoundingAgreesWithTheHost) {
  std::vector<float> numbers;
  for (float x = 0.0f; x < 4.0f; x += 0.125f) {  // includes halves, which round to even
    for (const float at : {x, 1000.0f + x, std::nextafter(x, 9.0f), 8388608.0f + x, 1e18f * x,
                           2e8f * x, 1e12f * x, 0x1p51f * std::nextafter(1.0f, x - 1.0f)})
      numbers.insert(numbers.end(), {at, -at});
  }
  const auto count = static_cast<uint>(numbers.size());
  ASSERT_EQ(count % 16, 0u);
  const Buffer in = upload(numbers), floors = device().allocate(count * sizeof(float)),
               wholes = device().allocate(count * sizeof(std::int64_t));
  run(GetParam(), "rounded", count / 16, {in, floors, wholes, count / 16});
  const auto floored = download<float>(floors, count);
  const auto whole = download<std::int64_t>(wholes, count);
  for (uint i = 0; i < count; ++i) {
    EXPECT_EQ(floored[i], std::floor(numbers[i])) << numbers[i];
    EXPECT_EQ(whole[i], std::llrint(numbers[i])) << numbers[i];
  }
}

INSTANTIATE_TEST_SUITE_P(ByCompiler, Lanes,
                         testing::Values("lanes", "lanes_without_avx512", "lanes_without_builtins"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace dapple
