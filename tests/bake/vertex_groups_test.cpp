// Groups of vertices that share a baked value (smooth seams, hard edges, two-sided sheets), and the
// positions and weights of samples on triangles.
#include "bake/vertex_groups.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>

#include "bake/placement_choice.hpp"
#include "bake/samples/surface_samples.hpp"
#include "sampling/random_choice.hpp"

namespace dapple {
namespace {

Mesh triangles(std::vector<V3f> positions) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.indices.push_back(i);
  mesh.materials.resize(mesh.positions.size() / 3, 0);
  return mesh;
}

// A square of two triangles that share no vertex, folded about its diagonal by an angle.
Mesh folded_square(float degrees) {
  const float angle = degrees * 3.14159265f / 180;
  const V3f a(0, 0, 0), b(1, 1, 0);
  const V3f side =
      V3f(-0.5f, 0.5f, 0) * std::cos(angle) + V3f(0, 0, std::sqrt(0.5f)) * std::sin(angle);
  return triangles({a, V3f(1, 0, 0), b, a, b, V3f(0.5f, 0.5f, 0) + side});
}

TEST(VertexGroups, ASmoothSeamIsOneGroupAndAHardEdgeIsTwo) {
  const VertexGroups smooth = group_vertices(folded_square(20));
  EXPECT_EQ(smooth.count, 4u);
  EXPECT_EQ(smooth.of_vertex[0], smooth.of_vertex[3]);
  EXPECT_EQ(smooth.of_vertex[2], smooth.of_vertex[4]);
  EXPECT_EQ(group_vertices(folded_square(90)).count, 6u);
}

TEST(VertexGroups, MinusZeroIsZero) {
  Mesh mesh = folded_square(0);
  mesh.positions[3] = V3f(-0.0f, 0, -0.0f);  // as the first corner
  EXPECT_EQ(group_vertices(mesh).count, 4u);
}

TEST(VertexGroups, OppositeNormalsAreSimilarOnlyOfTwoSidedSheets) {
  Mesh mesh = folded_square(0);
  std::swap(mesh.indices[4], mesh.indices[5]);  // the second triangle's other side
  EXPECT_EQ(group_vertices(mesh).count, 6u);
  EXPECT_EQ(group_vertices(mesh, {true, false}).count, 6u) << "only one of them has two sides";
  const VertexGroups groups = group_vertices(mesh, {true, true});
  EXPECT_EQ(groups.count, 4u);
  // The last vertex is a group of its own.
  EXPECT_EQ(groups.turned, (std::vector<bool>{false, false, false, true, true, false}));
  const std::vector<bool> two_sided{true, true};
  EXPECT_EQ(sample_triangle({mesh, groups, two_sided}, 0, 0).turned, (std::array<bool, 3>{}));
  EXPECT_EQ(sample_triangle({mesh, groups, two_sided}, 1, 0).turned,
            (std::array<bool, 3>{true, false, true}));
}

TEST(VertexGroups, PartsAreJoinedByTriangles) {
  Mesh mesh = folded_square(0);
  for (const V3f& p : triangles({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}).positions)
    mesh.positions.push_back(p);
  mesh.indices.insert(mesh.indices.end(), {6, 7, 8});
  mesh.materials.push_back(0);
  const VertexGroups groups = group_vertices(mesh);
  const std::vector<std::uint32_t> part = connected_parts(mesh, groups);
  EXPECT_EQ(groups.count, 7u);
  EXPECT_EQ(part[groups.of_vertex[0]], part[groups.of_vertex[5]]);
  EXPECT_NE(part[groups.of_vertex[0]], part[groups.of_vertex[8]]);
}

/// Processor time, in seconds, of grouping the corners of `count` triangles that are a point, all
/// the same one: the minimum of several runs. Without areas they have no normals, which are similar
/// to nothing, so that each vertex is compared with as many others as any can be.
double grouping_seconds(std::size_t count) {
  const Mesh mesh = triangles(std::vector<V3f>(3 * count, V3f(1, 2, 3)));
  double min = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 3; ++run) {
    const std::clock_t start = std::clock();
    const VertexGroups groups = group_vertices(mesh);
    min = std::min(min, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    EXPECT_EQ(groups.count, 3 * count) << "each vertex is a group";
  }
  return min;
}

// Ten times the vertices should take ten times the time. Comparing all pairs would take a hundred
// times. The limit of 30 leaves room for disturbed measurements and for caches.
TEST(VertexGroups, ManyVerticesAtOnePointTakeLinearTime) {
  const double few = grouping_seconds(10'000), many = grouping_seconds(100'000);
  EXPECT_LT(many / few, 30) << many << " s and " << few << " s";
}

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
  const Mesh mesh = triangles({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}});
  const VertexGroups groups = group_vertices(mesh);
  const std::vector<bool> two_sided{true};
  const SurfaceSample sample = sample_triangle({mesh, groups, two_sided}, 0, 5);
  EXPECT_NEAR(sample.weight[0] + sample.weight[1] + sample.weight[2], 6.0f, 1e-5f);
  EXPECT_TRUE(sample.front && sample.back);
}

TEST(SurfaceSamples, DegenerateTrianglesHaveNoArea) {
  const Mesh mesh = triangles({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}});
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
