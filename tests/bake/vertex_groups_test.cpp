// Groups of vertices that share a baked value: smooth seams, hard edges, two-sided sheets.
#include "bake/vertex_groups.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ctime>
#include <limits>

#include "bake/samples/surface_samples.hpp"
#include "support/scenes/separate_triangles.hpp"

namespace dapple {
namespace {

// A square of two triangles that share no vertex, folded about its diagonal by an angle.
Mesh folded_square(float degrees) {
  const float angle = degrees * 3.14159265f / 180;
  const V3f a(0, 0, 0), b(1, 1, 0);
  const V3f side =
      V3f(-0.5f, 0.5f, 0) * std::cos(angle) + V3f(0, 0, std::sqrt(0.5f)) * std::sin(angle);
  return test::separate_triangles({a, V3f(1, 0, 0), b, a, b, V3f(0.5f, 0.5f, 0) + side});
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
  for (const V3f& p : test::separate_triangles({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}).positions)
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
  const Mesh mesh = test::separate_triangles(std::vector<V3f>(3 * count, V3f(1, 2, 3)));
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

}  // namespace
}  // namespace dapple
