// Samples on triangles: positions, weights, and how rays are divided over them.
#include "bake/samples/surface_samples.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "bake/vertex_groups.hpp"
#include "support/scenes/separate_triangles.hpp"

namespace dapple {
namespace {

TEST(SurfaceSamples, TheFirstPowersOfFourLieInDifferentPartsOfATriangle) {
  for (const std::uint32_t shift : {0u, 0x1234u, 0xffffu}) {
    for (const std::uint32_t count : {4u, 16u, 64u}) {
      const auto across = static_cast<float>(std::lround(std::sqrt(count)));
      std::set<std::array<int, 3>> parts;
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::array<float, 3> at = triangle_point(i ^ shift);
        EXPECT_NEAR(at[0] + at[1] + at[2], 1.0f, 1e-5f);
        std::array<int, 3> part{};
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_GT(at[k], 0.0f);
          part[k] = static_cast<int>(at[k] * across);
        }
        parts.insert(part);
      }
      EXPECT_EQ(parts.size(), count) << shift;
    }
  }
}

TEST(SurfaceSamples, WeightsOfASampleAddUpToTwiceTheArea) {
  const Mesh mesh = test::separate_triangles({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}});
  const VertexGroups groups = group_vertices(mesh);
  const std::vector<bool> two_sided{true};
  const SurfaceSample sample = sample_triangle({mesh, groups, two_sided}, 0, 5);
  EXPECT_NEAR(sample.weight[0] + sample.weight[1] + sample.weight[2], 6.0f, 1e-5f);
  EXPECT_TRUE(sample.front && sample.back);
}

TEST(SurfaceSamples, DegenerateTrianglesHaveNoArea) {
  const Mesh mesh = test::separate_triangles(
      {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}});
  EXPECT_FALSE(has_area(mesh, 0));
  EXPECT_FALSE(has_area(mesh, 1));
}

TEST(SurfaceSamples, RaysAreDividedOverSixtyFourSamplesAtMost) {
  for (const auto& [rays, samples] :
       {std::pair{8, 1}, {15, 1}, {16, 2}, {512, 64}, {1024, 64}, {65536, 64}}) {
    const SampleCounts counts = sample_counts(rays, 1);
    EXPECT_EQ(counts.samples, samples) << rays;
    EXPECT_EQ(counts.rays, rays / samples) << rays;
  }
}

TEST(SurfaceSamples, PlacementsHaveEquallyManySamplesIfThereAreEnough) {
  struct Case {
    int rays;
    std::size_t placements;
    bool at_vertex;
    int samples;
  };
  for (const Case& c : {Case{64, 100, false, 8},
                        {512, 5, false, 60},
                        {65536, 5, false, 80},
                        {65536, 100, false, 1600},
                        {1024, 1000, false, 128},
                        {4096, 1, true, 2},
                        {4096, 5, true, 10},
                        {32, 5, true, 4}}) {
    const SampleCounts counts = sample_counts(c.rays, c.placements, c.at_vertex);
    EXPECT_EQ(counts.samples, c.samples) << c.rays << ", " << c.placements;
    EXPECT_EQ(counts.rays, c.rays / c.samples);
  }
}

}  // namespace
}  // namespace dapple
