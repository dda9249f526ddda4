// The shading normals of a triangle's corners: none for a flat triangle, however long its normals
// are and whichever way they point; else unit normals on the side of the face.
#include "scene/corner_normals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dapple {
namespace {

constexpr float kDegree = 0.017453293f;

/// A triangle whose face's normal is +z.
Mesh triangle_with(const V3f& a, const V3f& b, const V3f& c) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0.02f, 0, 0}, {0, 0.03f, 0}};
  mesh.indices = {0, 1, 2};
  mesh.materials = {0};
  mesh.normals = {a, b, c};
  return mesh;
}

V3f bent(float degrees) { return {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)}; }

TEST(CornerNormals, AreNotGivenForNormalsOfTheFaceOfAnyLengthOnEitherSide) {
  EXPECT_FALSE(corner_normals(triangle_with({0, 0, 1}, {0, 0, 1e-12f}, {0, 0, 1e12f}), 0));
  EXPECT_FALSE(corner_normals(triangle_with({0, 0, -1}, {0, 0, -3}, {0, 0, -0.1f}), 0));
  EXPECT_FALSE(corner_normals(triangle_with(bent(0.05f), bent(-0.05f), bent(0.05f)), 0));
}

TEST(CornerNormals, ZerosStandForTheNormalOfTheFace) {
  const V3f zero(0, 0, 0);
  EXPECT_FALSE(corner_normals(triangle_with(zero, zero, zero), 0));
  EXPECT_FALSE(corner_normals(triangle_with(zero, {0, 0, 2}, zero), 0));
  const auto normals = corner_normals(triangle_with(zero, bent(10), zero), 0);
  ASSERT_TRUE(normals);
  EXPECT_EQ((*normals)[0], V3f(0, 0, 1));
  EXPECT_NEAR((*normals)[1].x, std::sin(10 * kDegree), 1e-6f);
}

TEST(CornerNormals, AreTurnedToTheSideOfTheFace) {
  const auto normals = corner_normals(triangle_with(-bent(10), -bent(10), {0, 0, -5}), 0);
  ASSERT_TRUE(normals);
  EXPECT_TRUE((*normals)[0].equalWithAbsError(bent(10), 1e-6f));
  EXPECT_TRUE((*normals)[2].equalWithAbsError(V3f(0, 0, 1), 1e-6f));
}

TEST(CornerNormals, OneThatPointsAwayFromTheOthersIsNotFlat) {
  EXPECT_TRUE(corner_normals(triangle_with({0, 0, 1}, {0, 0, 1}, {0, 0, -1}), 0));
}

TEST(CornerNormals, BendsOfMoreThanATenthOfADegreeCount) {
  EXPECT_TRUE(corner_normals(triangle_with({0, 0, 1}, {0, 0, 1}, bent(0.2f)), 0));
}

TEST(CornerNormals, ThatAreNotNumbersAreNotGiven) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(corner_normals(triangle_with({nan, 0, 1}, {0, 0, 1}, {0, 0, 1}), 0));
}

}  // namespace
}  // namespace dapple
