// Which placement of a mesh each sample of a triangle takes.
#include "bake/placement_choice.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

TEST(PlacementChoice, SamplesInTurnTakeAllPlacements) {
  for (const std::uint32_t placements : {1u, 2u, 3u, 8u, 100u, 1000u}) {
    for (const std::uint32_t random : {0u, 1u, 77u, 0xdeadbeefu}) {
      std::vector<int> taken(placements);
      for (std::uint32_t i = 0; i < 3 * placements; ++i)
        ++taken.at(placement_of_sample(i, placements, random));
      for (const int count : taken) EXPECT_EQ(count, 3);
    }
  }
}

// Sample k of a triangle lies in a part of it that k says. 40,000 triangles: a share of 1 / n has a
// standard error of 0.5 / 200 at most.
TEST(PlacementChoice, EachSampleTakesAnyPlacementEquallyOften) {
  constexpr std::uint32_t kTriangles = 40000;
  for (const std::uint32_t placements : {2u, 3u, 4u, 7u, 20u}) {
    for (std::uint32_t sample = 0; sample < 2 * placements; ++sample) {
      std::vector<int> taken(placements);
      for (std::uint32_t t = 0; t < kTriangles; ++t)
        ++taken.at(placement_of_sample(sample, placements, hash_of(7, t)));
      for (const int count : taken)
        EXPECT_NEAR(static_cast<double>(count) / kTriangles, 1.0 / placements, 0.0125)
            << sample << " of " << placements;
    }
  }
}

}  // namespace
}  // namespace dapple
