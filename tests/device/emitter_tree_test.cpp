#include "device/upload/emitter_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple {
namespace {

std::vector<EmitterTriangle> triangles_in_a_row(std::size_t count) {
  std::vector<EmitterTriangle> triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    EmitterTriangle& t = triangles[i];
    // In no order: 7 and the counts below have no common factor.
    t.vertex[0] = static_cast<float>(i * 7 % count) * 10;
    t.vertex[2] = static_cast<float>(i % 3);
    t.edge1[1] = 1;
    t.edge2[0] = 2;
    t.area = static_cast<float>(i % 5 + 1);
  }
  return triangles;
}

V3f corner(const EmitterTriangle& t, int k) {
  V3f at(t.vertex[0], t.vertex[1], t.vertex[2]);
  const float* edge = k == 1 ? t.edge1 : t.edge2;
  if (k > 0) at += V3f(edge[0], edge[1], edge[2]);
  return at;
}

/// Checks the node [first, end) and all below it. Returns the area of its triangles.
double expect_sound(const std::vector<EmitterTriangle>& triangles, std::size_t first,
                    std::size_t end) {
  if (end - first == 1) return double{triangles[first].area};
  const std::size_t middle = (first + end) / 2;
  const EmitterTriangle& node = triangles[middle];
  for (std::size_t i = first; i < end; ++i) {
    const float* box = i < middle ? node.left : node.right;
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_LE(std::fabs(corner(triangles[i], k)[axis] - box[axis]), box[axis + 3]);
  }
  const double left = expect_sound(triangles, first, middle);
  const double right = expect_sound(triangles, middle, end);
  EXPECT_FLOAT_EQ(node.left_share, static_cast<float>(left / (left + right)));
  return left + right;
}

TEST(EmitterTree, BoxesHoldTheirTrianglesAndSharesAreOfTheirAreas) {
  for (const std::size_t count : {1u, 2u, 3u, 64u, 1000u, 10000u}) {
    std::vector<EmitterTriangle> triangles = triangles_in_a_row(count);
    double area = 0;
    for (const EmitterTriangle& t : triangles) area += double{t.area};
    order_emitters(triangles);
    EXPECT_DOUBLE_EQ(expect_sound(triangles, 0, count), area);
  }
}

TEST(EmitterTree, NeighboursComeToLieSideBySide) {
  std::vector<EmitterTriangle> triangles = triangles_in_a_row(1024);
  order_emitters(triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    EXPECT_EQ(triangles[i].vertex[0], static_cast<float>(i) * 10);
  EXPECT_LT(triangles[512].left[3], 0.51f * 512 * 10);
}

double sum_of_areas(const std::vector<EmitterTriangle>& triangles) {
  double sum = 0;
  for (const EmitterTriangle& t : triangles) {
    const V3f from = corner(t, 0);
    sum += 0.5 * double{(corner(t, 1) - from).cross(corner(t, 2) - from).length()};
  }
  return sum;
}

TEST(EmitterTree, LongTrianglesAreDividedIntoShortOnes) {
  // A right-angled one, as of a twig, and a needle; both face +Z.
  EmitterTriangle right{}, needle{}, line{};
  right.edge1[0] = 1;
  right.edge2[1] = 0.01f;
  right.area = 0.0025f;  // half opaque
  needle.edge1[0] = 1;
  needle.edge1[1] = -0.005f;
  needle.edge2[0] = 1;
  needle.edge2[1] = 0.005f;
  needle.area = 0.005f;
  line.edge1[0] = line.edge2[0] = 1;
  line.edge2[1] = 1e-7f;
  line.area = 1e-8f;
  for (const EmitterTriangle& t : {right, needle, line}) {
    std::vector<EmitterTriangle> pieces = {t};
    divide_long_emitters(pieces);
    double area = 0;
    float longest = 0;
    for (const EmitterTriangle& piece : pieces) {
      area += double{piece.area};
      for (int k = 1; k < 3; ++k)
        longest = std::max(longest, (corner(piece, k) - corner(piece, 0)).length());
      EXPECT_GE((corner(piece, 1) - corner(piece, 0)).cross(corner(piece, 2) - corner(piece, 0)).z,
                0);
    }
    EXPECT_NEAR(area, t.area, 1e-6 * double{t.area});
    EXPECT_NEAR(sum_of_areas(pieces), sum_of_areas({t}), 1e-6);
    EXPECT_LE(longest, t.area == line.area ? 1.01f : 0.035f);
    EXPECT_LE(pieces.size(), 4u * 34);
  }
}

TEST(EmitterTree, OfVeryManyLongTrianglesFewPiecesAreMade) {
  EmitterTriangle twig{};
  twig.edge1[0] = 1;
  twig.edge2[1] = 0.001f;
  twig.area = 0.0005f;
  std::vector<EmitterTriangle> pieces(20000, twig);
  divide_long_emitters(pieces);
  EXPECT_GT(pieces.size(), 20000u);
  EXPECT_LE(pieces.size(), 20000u + (1u << 17));
}

}  // namespace
}  // namespace dapple
