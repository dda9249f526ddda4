// Triangles of a leaf that share edges: which lie side by side, and quads that are drawn at once.
#include "bvh/opacity/covering_triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "bvh/opacity/coverage_map.hpp"

namespace dapple {
namespace {

constexpr int kZ = 2;  // seen along it, columns are x and rows are y

const Box3f kUnit(V3f(0, 0, 0), V3f(1, 1, 1));

CoveringTriangle triangle_of(const V3f& a, const V3f& b, const V3f& c, float opacity = 1) {
  return {a, b - a, c - a, opacity};
}

SharedEdges edges_of(std::span<const CoveringTriangle> triangles) {
  return SharedEdges(Covering{triangles, triangles, triangles});
}

const auto kNotVarying = [](const CoveringTriangle&, float, float, float) -> float {
  ADD_FAILURE() << "a uniform triangle was looked up";
  return 0;
};

/// Mean of |covered - expected| over the map's cells seen along z, where expected are the shares of
/// 16 x 16 points a cell inside one of the triangles.
double error_of(const CoverageMap& map, std::span<const CoveringTriangle> triangles) {
  const auto is_inside = [&](double x, double y) {
    for (const CoveringTriangle& t : triangles) {
      const double px = x - t.vertex.x, py = y - t.vertex.y;
      const double area = double{t.edge1.x} * t.edge2.y - double{t.edge1.y} * t.edge2.x;
      const double u = (px * t.edge2.y - py * t.edge2.x) / area;
      const double v = (t.edge1.x * py - t.edge1.y * px) / area;
      if (u >= 0 && v >= 0 && u + v <= 1) return true;
    }
    return false;
  };
  constexpr int kPoints = 16;
  double sum = 0;
  for (int row = 0; row < kMapSize; ++row) {
    for (int column = 0; column < kMapSize; ++column) {
      int inside = 0;
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const double x = (column + (i % kPoints + 0.5) / kPoints) / kMapSize;
        const double y = (row + (i / kPoints + 0.5) / kPoints) / kMapSize;
        inside += is_inside(x, y) ? 1 : 0;
      }
      const double covered = 1.0 - map.transmittance[kZ][row * kMapSize + column];
      sum += std::fabs(covered - inside / double{kPoints * kPoints});
    }
  }
  return sum / kMapCells;
}

/// A quad of four corners in convex order, cut from corner 0 to corner 2, with a crease.
std::vector<CoveringTriangle> random_quad(std::mt19937& random) {
  std::uniform_real_distribution<float> share(0, 1);
  V3f corner[4];
  const float turn = 6.28f * share(random);
  for (int i = 0; i < 4; ++i) {
    const float angle = turn + 1.5708f * (static_cast<float>(i) + 0.5f * share(random));
    corner[i] = V3f(0.5f + 0.49f * std::cos(angle), 0.5f + 0.49f * std::sin(angle), share(random));
  }
  return {triangle_of(corner[0], corner[1], corner[2]),
          triangle_of(corner[2], corner[3], corner[0])};
}

TEST(SharedEdges, TrianglesOnOppositeSidesOfAnEdgeAreNeighbours) {
  const V3f a(0, 0, 0.5f), b(1, 0, 0.5f), c(1, 1, 0.5f), d(0, 1, 0.5f);
  // The third lies on the same side of the edge from a to c as the first.
  const std::array triangles{triangle_of(a, b, c), triangle_of(c, d, a),
                             triangle_of(a, V3f(0.9f, 0.1f, 0.2f), c), triangle_of(b, a, d)};
  const SharedEdges edges = edges_of(triangles);
  EXPECT_EQ(edges.neighbours(kZ, 0), 0b0010u);
  EXPECT_EQ(edges.neighbours(kZ, 1), 0b0101u);
  EXPECT_EQ(edges.neighbours(kZ, 2), 0b0010u);
  EXPECT_EQ(edges.neighbours(kZ, 3), 0u) << "on the same side of the edges that it shares";
  EXPECT_EQ(edges.neighbours(0, 0) & 0b0010u, 0u) << "seen edge on, there are no sides";
}

TEST(SharedEdges, EachPermutationOfTheCornersHasItsPartner) {
  const V3f corners[4] = {
      {0.1f, 0.2f, 0.3f}, {0.8f, 0.1f, 0.5f}, {0.9f, 0.9f, 0.1f}, {0.2f, 0.7f, 0.6f}};
  for (int turn = 0; turn < 36; ++turn) {
    const int p[3] = {0, 1, 2}, q[3] = {0, 2, 3};
    const auto permuted = [&](const int(&of)[3], int how) {
      const int first = how % 3, step = how / 3 + 1;
      return triangle_of(corners[of[first]], corners[of[(first + step) % 3]],
                         corners[of[(first + 2 * step) % 3]]);
    };
    const std::array triangles{permuted(p, turn % 6), permuted(q, turn / 6)};
    const SharedEdges edges = edges_of(triangles);
    ASSERT_EQ(edges.partner(kZ, 0).triangle, 1) << turn;
    ASSERT_EQ(edges.partner(kZ, 1).triangle, 0) << turn;
    for (int t = 0; t < 2; ++t) {
      const V3f far = corner_of(triangles[t], edges.partner(kZ, t).corner);
      EXPECT_TRUE(far.equalWithAbsError(corners[t == 0 ? 1 : 3], 1e-6f)) << turn;
      const CoveringTriangle first = turned(triangles[t], edges.partner(kZ, t).corner);
      EXPECT_EQ(first.vertex, far);
      EXPECT_GT(first.edge1.cross(first.edge2).dot(triangles[t].edge1.cross(triangles[t].edge2)),
                0);
    }
  }
}

TEST(SharedEdges, OnlyTrianglesOfTheSameOpacityArePartners) {
  const V3f a(0, 0, 0.5f), b(1, 0, 0.5f), c(1, 1, 0.5f), d(0, 1, 0.5f);
  for (const auto& [one, other, closed] :
       {std::tuple{0.5f, 0.6f, false}, {-1.0f, -1.0f, false}, {1.0f, 1.0f, true}}) {
    std::array triangles{triangle_of(a, b, c, one), triangle_of(c, d, a, other)};
    triangles[1].closed = closed;
    const SharedEdges edges = edges_of(triangles);
    EXPECT_EQ(edges.neighbours(kZ, 0), 0b10u);
    EXPECT_LT(edges.partner(kZ, 0).triangle, 0);
  }
}

TEST(SharedEdges, ATriangleIsInOneQuad) {
  // A fan: the middle one has two neighbours.
  const V3f hub(0.5f, 0, 0.5f),
      rim[4] = {{0, 0.4f, 0.5f}, {0.3f, 0.9f, 0.5f}, {0.7f, 0.9f, 0.5f}, {1, 0.4f, 0.5f}};
  std::vector<CoveringTriangle> fan;
  for (int i = 0; i < 3; ++i) fan.push_back(triangle_of(hub, rim[i], rim[i + 1]));
  const SharedEdges edges = edges_of(fan);
  EXPECT_FALSE(edges.is_single_layer()) << "seen edge on they are not side by side";
  EXPECT_EQ(edges.partner(kZ, 0).triangle, 1);
  EXPECT_EQ(edges.partner(kZ, 1).triangle, 0);
  EXPECT_LT(edges.partner(kZ, 2).triangle, 0);
}

TEST(CoverageMap, AQuadCoversWhatItsTrianglesCover) {
  std::mt19937 random(5);
  double alone = 0, together = 0;
  for (int i = 0; i < 200; ++i) {
    const std::vector<CoveringTriangle> quad = random_quad(random);
    ASSERT_GE(edges_of(quad).partner(kZ, 0).triangle, 0) << i;
    CoverageMap map, of_two;
    cover(map, kUnit, quad, kNotVarying);
    // Opacities that hardly differ are drawn one by one.
    std::vector<CoveringTriangle> two = quad;
    two[1].opacity = 0.9999f;
    ASSERT_LT(edges_of(two).partner(kZ, 0).triangle, 0) << i;
    cover(of_two, kUnit, two, kNotVarying);
    const V3f diagonal = quad[0].edge2,
              other = quad[1].vertex + quad[1].edge1 - corner_of(quad[0], 1);
    EXPECT_NEAR(map.mean_opacity(kZ), 0.5f * std::fabs(diagonal.cross(other)[kZ]), 1e-5) << i;
    together += error_of(map, quad);
    alone += error_of(of_two, quad);
  }
  // Two triangles lose what is more than a whole cell along the cut between them.
  EXPECT_LT(together / 200, 0.014);
  EXPECT_LT(together, alone);
}

TEST(CoverageMap, AQuadThatIsNotConvexIsTwoTriangles) {
  // An arrowhead: the corner at (0.5, 0.4) points inwards.
  const V3f tip(0.5f, 0.95f, 0.5f), left(0.05f, 0.05f, 0.5f), dent(0.5f, 0.4f, 0.5f),
      right(0.95f, 0.05f, 0.5f);
  const std::array head{triangle_of(tip, left, dent), triangle_of(dent, right, tip)};
  ASSERT_EQ(edges_of(head).partner(kZ, 0).triangle, 1);
  CoverageMap map;
  cover(map, kUnit, head, kNotVarying);
  EXPECT_NEAR(map.mean_opacity(kZ), 0.45f * 0.55f, 1e-5);
  EXPECT_LT(error_of(map, head), 0.025);
  // In the dent there is nothing.
  EXPECT_EQ(map.transmittance[kZ][1 * kMapSize + kMapSize / 2], 1.0f);
}

}  // namespace
}  // namespace dapple
