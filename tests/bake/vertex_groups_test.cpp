// Groups of vertices that share a baked value, and the samples of triangles.
#include "bake/vertex_groups.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/surface_samples.hpp"

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
  const VertexGroups smooth = group_vertices(folded_square(20), false);
  EXPECT_EQ(smooth.count, 4u);
  EXPECT_EQ(smooth.of_vertex[0], smooth.of_vertex[3]);
  EXPECT_EQ(smooth.of_vertex[2], smooth.of_vertex[4]);
  EXPECT_EQ(group_vertices(folded_square(90), false).count, 6u);
}

TEST(VertexGroups, OppositeNormalsAreSimilarOnlyOfTwoSidedSheets) {
  Mesh mesh = folded_square(0);
  std::swap(mesh.indices[4], mesh.indices[5]);  // the second triangle's other side
  EXPECT_EQ(group_vertices(mesh, false).count, 6u);
  EXPECT_EQ(group_vertices(mesh, true).count, 4u);
}

TEST(VertexGroups, PartsAreJoinedByTriangles) {
  Mesh mesh = folded_square(0);
  for (const V3f& p : triangles({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}).positions)
    mesh.positions.push_back(p);
  mesh.indices.insert(mesh.indices.end(), {6, 7, 8});
  mesh.materials.push_back(0);
  const VertexGroups groups = group_vertices(mesh, false);
  const std::vector<std::uint32_t> part = connected_parts(mesh, groups);
  EXPECT_EQ(groups.count, 7u);
  EXPECT_EQ(part[groups.of_vertex[0]], part[groups.of_vertex[5]]);
  EXPECT_NE(part[groups.of_vertex[0]], part[groups.of_vertex[8]]);
}

TEST(VertexGroups, ManyVerticesAtOnePointTakeLinearTime) {
  Mesh mesh;  // a fan of needles from one point, in all directions
  constexpr std::uint32_t kCount = 200'000;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const float angle = static_cast<float>(i);
    mesh.positions.emplace_back(0, 0, 0);
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), std::cos(3 * angle));
    mesh.positions.emplace_back(std::sin(angle), std::cos(2 * angle), 1);
    mesh.indices.insert(mesh.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.materials.resize(kCount, 0);
  EXPECT_GT(group_vertices(mesh, false).count, 2 * std::size_t{kCount} / 2);
}

// A polynomial of degree `d` in x and y over the triangle (0,0) (1,0) (0,1): its integral is
// i! j! / (i + j + 2)!.
double integral(int i, int j) {
  return std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3);
}

TEST(SurfaceSamples, IntegratePolynomialsUpToTheRulesDegreeExactly) {
  const Mesh mesh = triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const VertexGroups groups = group_vertices(mesh, false);
  for (const auto& [points, degree] : {std::pair{1, 1}, {3, 2}, {6, 4}, {12, 6}}) {
    std::vector<SurfaceSample> samples;
    sample_triangle(mesh, 0, groups, false, points, samples);
    ASSERT_EQ(samples.size(), static_cast<std::size_t>(points));
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) {
        double sum = 0;
        for (const SurfaceSample& s : samples) {
          const double weight = 0.5 * (double{s.weight[0]} + s.weight[1] + s.weight[2]);
          sum += weight * std::pow(double{s.position.x}, i) * std::pow(double{s.position.y}, j);
        }
        EXPECT_NEAR(sum, integral(i, j), 1e-6) << points << " points, x^" << i << " y^" << j;
      }
    }
  }
}

TEST(SurfaceSamples, TrianglesWithoutAnAreaHaveNone) {
  const Mesh mesh = triangles({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}});
  const VertexGroups groups = group_vertices(mesh, false);
  std::vector<SurfaceSample> samples;
  sample_triangle(mesh, 0, groups, false, 12, samples);
  sample_triangle(mesh, 1, groups, false, 12, samples);
  EXPECT_TRUE(samples.empty());
}

TEST(SurfaceSamples, RaysAreDividedOverPointsOfSixteenRaysAndMore) {
  for (const auto& [rays, points] :
       {std::pair{16, 1}, {47, 1}, {48, 3}, {95, 3}, {96, 6}, {191, 6}, {192, 12}, {65536, 12}}) {
    const SampleCounts counts = sample_counts(rays);
    EXPECT_EQ(counts.points, points) << rays;
    EXPECT_EQ(counts.rays, rays / points) << rays;
  }
}

}  // namespace
}  // namespace dapple
