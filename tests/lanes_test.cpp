// Comparisons' lanes as bits, and back: of every pattern, in each way in which kernels/lanes.clh
// may be compiled.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

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

INSTANTIATE_TEST_SUITE_P(ByCompiler, Lanes,
                         testing::Values("lanes", "lanes_without_avx512", "lanes_without_builtins"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace dapple
