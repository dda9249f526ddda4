// Where in its box a node has its mass: how maps tell it, how nodes store it, and the weights of
// rays that pass near it or far from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/quantize_opacity.hpp"
#include "dapple/shared/opacity.h"
#include "support/random_direction.hpp"
#include "support/scenes/uniform_map.hpp"

namespace dapple {
namespace {

/// Of the line through `p` along `direction`: the middle of its chord of the box from -1 to 1.
V3f middle_of_chord(const V3f& p, const V3f& direction) {
  float enter = -100, leave = 100;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = (-1 - p[axis]) / direction[axis], b = (1 - p[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return p + direction * (0.5f * (enter + leave));
}

TEST(MassShape, CentreWeightsKeepTheMeanDepthOfRaysThatFillTheBox) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const float mass_concentration : {1 / 3.0f, 2 / 3.0f, 1.0f}) {
    for (int d = 0; d < 20; ++d) {
      const V3f direction = random_direction(random);
      double weights = 0;
      constexpr int kPoints = 20000;
      // A uniform point in the box selects a ray with a probability in proportion to the ray's
      // length inside the box. This is the weight of the ray in the mean optical depth.
      for (int i = 0; i < kPoints; ++i) {
        const V3f p(unit(random), unit(random), unit(random));
        weights += centre_weight(mass_concentration, middle_of_chord(p, direction).length2(), 0);
      }
      // The mean off_centre is 0.667 to 0.707, depending on the direction; the model uses 0.68. The
      // minimum weight adds to the error.
      EXPECT_NEAR(weights / kPoints, 1, 0.045 * mass_concentration + 0.005) << direction;
    }
  }
}

TEST(MassShape, SurfacesThroughTheMiddleOfABoxHaveMassConcentration) {
  CoverageMap middle, uniform = uniform_map({0.3f, 0.3f, 0.3f}), corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 4; row < 12; ++row) {
      for (int column = 4; column < 12; ++column)
        middle.transmittance[axis][row * kMapSize + column] = 0.2f;
    }
    for (const int cell : {0, kMapSize - 1, kMapCells - kMapSize, kMapCells - 1})
      corners.transmittance[axis][cell] = 0.2f;
  }
  const Box3f box(V3f(0, 0, 0), V3f(1, 2, 3));
  EXPECT_EQ(map_opacity(middle, {}, box).mass.concentration, 1);
  EXPECT_EQ(map_opacity(uniform, {}, box).mass.concentration, 0);
  EXPECT_EQ(map_opacity(corners, {}, box).mass.concentration, 0);
}

TEST(MassShape, TheMassPoleIsWhereTheContentsOfABoxAre) {
  CoverageMap corner, middle;
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column)
        corner.transmittance[axis][row * kMapSize + column] = 0.2f;
    for (int row = 5; row < 11; ++row)
      for (int column = 5; column < 11; ++column)
        middle.transmittance[axis][row * kMapSize + column] = 0.2f;
  }
  const Box3f box(V3f(0, 0, 0), V3f(1, 2, 3));
  const MassShape shape = map_opacity(corner, {}, box).mass;
  EXPECT_GT(shape.concentration, 0.5f);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(shape.pole[axis], -0.75f) << axis;
  // Rays through that corner meet more than rays through the opposite one.
  const float near = centre_weight(shape.concentration, 0, shape.pole.length2()),
              far = centre_weight(shape.concentration, (V3f(0.75f) - shape.pole).length2(),
                                  shape.pole.length2());
  EXPECT_GT(near, 2);
  EXPECT_EQ(far, DAPPLE_MIN_CENTRE_WEIGHT);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ(std::fabs(map_opacity(middle, {}, box).mass.pole[axis]), 0.25f) << axis;
}

TEST(MassShape, StoredMassPolesComeBack) {
  BvhNode node{};
  set_grid(node, Box3f(V3f(0, 0, 0), V3f(1, 1, 1)));
  const Box3f box(V3f(0, 0, 0), V3f(1, 1, 1));
  set_child_box(node, 3, box);
  NodeOpacity opacity;
  opacity.axes = V3f(0.5f, 0.4f, 0.3f);
  for (int code = 0; code < 64; ++code) {
    opacity.mass.concentration = 2.0f / 3.0f;
    for (int axis = 0; axis < 3; ++axis)
      opacity.mass.pole[axis] = 0.5f * static_cast<float>(code >> 2 * axis & 3) - 0.75f;
    set_child_opacity(node, 3, opacity, box);
    for (unsigned axis = 0; axis < 3; ++axis)
      EXPECT_EQ(bvh_mass_pole(node.correlation, axis, 3), opacity.mass.pole[axis]);
    EXPECT_NEAR(bvh_mass_concentration(node.leaf_end, 3), 2.0f / 3.0f, 1e-6f);
  }
}

TEST(MassShape, MeanWeightsAreThoseOfRaysThroughABox) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int level = 1; level <= 3; ++level) {
    for (int away = 0; away <= 3; ++away) {
      MassShape shape;
      shape.concentration = static_cast<float>(level) / 3.0f;
      for (int axis = 0; axis < 3; ++axis) shape.pole[axis] = axis < away ? 0.75f : -0.25f;
      double weights = 0;
      constexpr int kPoints = 40000;
      for (int i = 0; i < kPoints; ++i) {
        const V3f p(unit(random), unit(random), unit(random));
        const V3f direction = random_direction(random);
        const V3f middle = middle_of_chord(p, direction);
        weights += centre_weight(shape.concentration, (middle - shape.pole).length2(),
                                 shape.pole.length2());
      }
      // Five standard errors of weights whose variance is below 1.
      EXPECT_NEAR(weights / kPoints, shape.mean_weight(), 0.025) << level << ", " << away;
    }
  }
}

}  // namespace
}  // namespace dapple
