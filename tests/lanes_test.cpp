// Comparisons' lanes as bits, and back, and what is pushed by them: of every pattern, in each way
// in which kernels/lanes.clh may be compiled.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "dapple/shared/bvh_node.h"
#include "test_kernel.hpp"

namespace dapple {
namespace {

using namespace kernel_test;

class Lanes : public testing::TestWithParam<const char*> {};

TEST_P(Lanes, AreBitsOfEveryPattern) {
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
        const uint place = expected[0]++;
        expected[1 + place] = next;
        expected[9 + place] = slot + 1;
      }
      next += inner;
    }
    const auto* at = &found[kValues * pattern];
    ASSERT_EQ(std::vector<uint>(at, at + kValues), expected) << "pattern " << pattern;
  }
}

INSTANTIATE_TEST_SUITE_P(ByCompiler, Lanes,
                         testing::Values("lanes", "lanes_without_avx512", "lanes_without_builtins"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace dapple
