// What nodes store of opacity: 8-bit codes of optical depths, and moments of the normals of the
// occluding surfaces.
#include "bvh/opacity/quantize_opacity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "dapple/shared/opacity.h"

namespace dapple {
namespace {

BvhNode unit_node() {
  BvhNode node{};
  set_grid(node, Box3f(V3f(0, 0, 0), V3f(1, 1, 1)));
  set_child_box(node, 0, Box3f(V3f(0, 0, 0), V3f(1, 1, 1)));
  return node;
}

float stored_opacity(const BvhNode& node, int axis) {
  return 1 - std::exp(-decode_depth(node.depth[axis][0]));
}

TEST(OpacityCode, DecodingIsWithinHalfACodeAndKeepsSmallOpacities) {
  BvhNode node = unit_node();
  const Box3f grown = child_box(node, 0);
  for (int i = 0; i <= 10000; ++i) {
    const float opacity = static_cast<float>(i) / 10000.0f;
    set_child_opacity(node, 0, {V3f(opacity, 0, 1), {}}, grown);
    // The code stores the depth's square root r, in 255 steps up to 3.035. With h, half a step, the
    // error of the depth is at most 2 r h + h^2, and that of the opacity is this times the
    // transmittance.
    const float half = 0.5f / 255.0f * std::sqrt(DAPPLE_MAX_DEPTH);
    const float root = std::sqrt(depth_of(opacity));
    const float bound = (2 * root * half + half * half) * std::exp(-root * root + 2 * root * half);
    // The largest opacities are stored as the last code but one: the last one means a wall.
    ASSERT_NEAR(stored_opacity(node, 0), opacity, bound + 1e-6f + (opacity > 0.9998f ? 2e-4f : 0));
    ASSERT_TRUE(node.depth[0][0] > 0 || opacity < 2 * half * half) << opacity;
  }
  EXPECT_EQ(stored_opacity(node, 1), 0.0f);
  EXPECT_NEAR(stored_opacity(node, 2), 1 - DAPPLE_MIN_TRANSMITTANCE, 1e-5f);
}

TEST(OpacityCode, TheStoredOpacityIsThatOfTheEnlargedBox) {
  BvhNode node{};
  set_grid(node, Box3f(V3f(0, 0, 0), V3f(100, 50, 20)));
  // The box is a few grid steps wide, so that growing it doubles some areas.
  const Box3f exact(V3f(10.1f, 10.1f, 10.1f), V3f(10.9f, 10.5f, 10.3f));
  set_child_box(node, 0, exact);
  const V3f opacity(0.9f, 0.5f, 0.7f);
  set_child_opacity(node, 0, {opacity, {}}, exact);
  const Box3f grown = child_box(node, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const float expected = opacity[axis] * face_area(exact, axis) / face_area(grown, axis);
    EXPECT_LT(expected, 0.9f * opacity[axis]) << "the case does not test much";
    // The error of half a step, as above, is below 0.006 for every opacity.
    EXPECT_NEAR(stored_opacity(node, axis), expected, 0.006f);
  }
}

TEST(NormalMoments, ATiltedSheetIsSeenByItsProjectedAreaFromEverywhere) {
  // One surface with the area vector g: along every direction d it occludes the area |g . d|.
  const V3f g(0.3f, 0.5f, -0.4f), size(1, 1, 1);
  NodeOpacity sheet;
  sheet.normals.add(g, 1e-3f);
  for (int axis = 0; axis < 3; ++axis) sheet.axes[axis] = 1e-3f * std::fabs(g[axis]);
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 1000; ++i) {
    const V3f d = V3f(normal(random), normal(random), normal(random)).normalized();
    const float facing = std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z);
    // The sheet is thin, so that depth and opacity have a relative difference of 1e-3. Near grazing
    // directions the root of a difference rounds.
    EXPECT_NEAR(opacity_along(sheet, size, d) * facing, 1e-3f * std::fabs(g.dot(d)), 2e-6f);
  }
}

TEST(NormalMoments, TransformWithTheirInstanceForEveryMatrix) {
  const V3f g(0.2f, -0.7f, 0.4f);
  NormalMoments moments;
  moments.add(g, 0.5f);
  M44f m;
  m[0][0] = 2;
  m[1][0] = 0.5f;   // sheared
  m[2][2] = -0.3f;  // and mirrored
  // Area vectors transform by the cofactor matrix: the determinant times the transposed inverse.
  const M44f inverse = m.inverse();
  V3f turned;
  for (int i = 0; i < 3; ++i) {
    turned[i] = g.x * inverse[i][0] + g.y * inverse[i][1] + g.z * inverse[i][2];
  }
  NormalMoments expected;
  expected.add(turned, 0.5f);
  const V3f a = moments.placed(m).correlation(), b = expected.correlation();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-5f);
}

}  // namespace
}  // namespace dapple
