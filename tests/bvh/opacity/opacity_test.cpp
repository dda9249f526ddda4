// Directional opacity: the model that gives it along any direction, and the same model eight boxes
// at a time in footprint.clh. What nodes keep of it: stored_opacity_test.cpp.
#include "dapple/shared/opacity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize.hpp"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

V3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  V3f d;
  do {
    for (int a = 0; a < 3; ++a) d[a] = normal(random);
  } while (d.length() < 1e-3f);
  return d.normalized();
}

/// Optical depth of a box of `size` along unit `d`, its normals not correlated.
float depth_along(const V3f& opacity, const V3f& size, const V3f& d) {
  return box_depth(depth_of(opacity.x), depth_of(opacity.y), depth_of(opacity.z), 0, 0, 0,
                   size.y * size.z * std::fabs(d.x), size.z * size.x * std::fabs(d.y),
                   size.x * size.y * std::fabs(d.z));
}

/// What is in a box at random: any two kinds of surfaces, and opacities up to 0.999, whose
/// transmittances are not cut off.
NodeOpacity random_opacity(std::mt19937& random) {
  std::uniform_real_distribution<float> part(0.0f, 0.999f);
  NodeOpacity opacity;
  for (int axis = 0; axis < 3; ++axis) opacity.axes[axis] = part(random);
  opacity.normals.add(random_direction(random), part(random));
  opacity.normals.add(random_direction(random), part(random));
  return opacity;
}

TEST(OpacityModel, AClumpHidesItsEllipsoidsAreaFromAnyDirection) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    NodeOpacity clump = random_opacity(random);
    clump.clumping = 1;
    const V3f size(1, 2, 0.5f), d = random_direction(random), c = clump.normals.correlation();
    const float expected =
        box_depth(clump.axes.x, clump.axes.y, clump.axes.z, c.x * std::copysign(1.0f, d.x * d.y),
                  c.y * std::copysign(1.0f, d.y * d.z), c.z * std::copysign(1.0f, d.z * d.x),
                  size.y * size.z * std::fabs(d.x), size.z * size.x * std::fabs(d.y),
                  size.x * size.y * std::fabs(d.z));
    // Roundings of a dozen operations; the root of a difference doubles them.
    EXPECT_NEAR(opacity_along(clump, size, d), std::min(1.0f, expected), 1e-5f);
  }
}

TEST(OpacityModel, WhatLiesEvenlyHidesItsOpacityAlongEachAxis) {
  for (const float opacity : {0.0f, 0.001f, 0.3f, 0.7f, 0.99f, 0.9999f}) {
    NodeOpacity even;
    even.axes = V3f(opacity);
    for (int axis = 0; axis < 3; ++axis) {
      V3f direction(0.0f);
      direction[axis] = -2;
      // The exponential is known to 4e-6 of itself.
      EXPECT_NEAR(opacity_along(even, V3f(1, 2, 3), direction), opacity, 4e-6f);
    }
  }
}

TEST(OpacityModel, DepthsOfWhatLiesEvenlyNeedNoFactor) {
  std::mt19937 random(4);
  // Opacities are known to 4e-6 of transmittances, and slopes, where boxes are dense, are small.
  for (int i = 0; i < 1000; ++i)
    EXPECT_NEAR(clumping_factor(random_opacity(random), V3f(1, 2, 0.5f)), 1.0f, 1e-4f);
  EXPECT_EQ(clumping_factor({}, V3f(1, 2, 0.5f)), 1.0f);
}

TEST(OpacityModel, FactorsOfClumpsAreThoseOfTheirMirrorImagesAndOfAxesRenamed) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> part(0.0f, 1.0f);
  int changed = 0;
  for (int i = 0; i < 1000; ++i) {
    NodeOpacity clump = random_opacity(random);
    clump.clumping = part(random);
    clump.mass_concentration = part(random);
    clump.triangles = 100;
    const V3f size(1, 2, 0.5f);
    const float factor = clumping_factor(clump, size);
    changed += std::fabs(factor - 1.0f) > 0.05f;
    const auto& [xx, yy, zz, xy, yz, zx] = clump.normals.sum;
    NodeOpacity mirrored = clump, renamed = clump;
    mirrored.normals.sum = {xx, yy, zz, -xy, yz, -zx};
    renamed.normals.sum = {zz, xx, yy, zx, xy, yz};
    renamed.axes = V3f(clump.axes.z, clump.axes.x, clump.axes.y);
    EXPECT_NEAR(clumping_factor(mirrored, size), factor, 1e-4f);
    EXPECT_NEAR(clumping_factor(renamed, V3f(size.z, size.x, size.y)), factor, 1e-4f);
  }
  EXPECT_GT(changed, 300) << "the case does not test much";
}

/// Area hidden by the box, and its change with a factor on depths, over directions from everywhere.
struct HiddenArea {
  double wanted = 0, given = 0, change = 0;
};

HiddenArea hidden_area(const NodeOpacity& clump, const V3f& size, std::mt19937& random) {
  constexpr float kStep = 0.01f;
  const auto with_factor = [&](float factor) {
    NodeOpacity even = clump;
    even.clumping = 0;
    for (int axis = 0; axis < 3; ++axis)
      even.axes[axis] = 1.0f - std::exp(-factor * depth_of(clump.axes[axis]));
    return even;
  };
  const NodeOpacity less = with_factor(1 - kStep), even = with_factor(1),
                    more = with_factor(1 + kStep);
  HiddenArea hidden;
  for (int i = 0; i < 400; ++i) {
    const V3f d = random_direction(random);
    const double facing = size.y * size.z * std::fabs(d.x) + size.z * size.x * std::fabs(d.y) +
                          size.x * size.y * std::fabs(d.z);
    hidden.wanted += facing * opacity_along(clump, size, d);
    hidden.given += facing * opacity_along(even, size, d);
    hidden.change +=
        facing * (opacity_along(more, size, d) - opacity_along(less, size, d)) / (2 * kStep);
  }
  return hidden;
}

TEST(OpacityModel, FactorsMakeUpForWhatClumpsHideLessFromEverywhere) {
  std::mt19937 random(6);
  double factors = 0, expected = 0;
  for (int i = 0; i < 500; ++i) {
    NodeOpacity clump = random_opacity(random);
    clump.clumping = 0.3f;
    const V3f size(1, 2, 1.5f);
    const HiddenArea hidden = hidden_area(clump, size, random);
    factors += clumping_factor(clump, size) - 1;
    expected += (hidden.wanted - hidden.given) / hidden.change;
  }
  EXPECT_LT(expected, -0.02 * 500) << "the case does not test much";
  // Seven directions stand for all: to 3 % here. Diagonals weighted as the axes would be 11 % off.
  EXPECT_NEAR(factors / expected, 1, 0.05);
}

TEST(OpacityModel, ASolidBoxIsOpaqueInEveryDirection) {
  std::mt19937 random(1);
  for (const V3f& size : {V3f(1, 1, 1), V3f(1, 3, 0.2f), V3f(1, 0.01f, 1)}) {
    for (int i = 0; i < 1000; ++i) {
      const float depth = depth_along(V3f(1, 1, 1), size, random_direction(random));
      // The least transmittance, 1e-4, to the power 1 / sqrt(3) at worst: 0.0049.
      EXPECT_LT(std::exp(-depth), 0.005f);
    }
  }
}

TEST(OpacityModel, ASheetShowsItsOwnOpacityFaceOn) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float opacity : {0.01f, 0.3f, 0.7f, 0.93f, 0.99f}) {
      V3f opacities(0.0f), size(2, 3, 4), direction(0.0f);
      opacities[axis] = opacity;
      size[axis] = 0;
      direction[axis] = -1;
      EXPECT_NEAR(1 - std::exp(-depth_along(opacities, size, direction)), opacity, 1e-5f);
      // Edge on it has no area to be met.
      V3f edge_on(0.0f);
      edge_on[(axis + 1) % 3] = 1;
      EXPECT_NEAR(depth_along(opacities, size, edge_on), 0, 1e-6f);
    }
  }
}

TEST(OpacityModel, SmallOpacitiesAddUpLinearly) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const V3f d = random_direction(random), size(1, 2, 0.5f), opacity(1e-3f, 4e-4f, 2e-3f);
    const float once = depth_along(opacity, size, d), twice = depth_along(opacity * 2.0f, size, d);
    // -log(1 - x) = x + x^2 / 2: off by x / 2 in ratio, x up to 4e-3; 1e-7 / x by rounding.
    EXPECT_NEAR(twice / once, 2, 3e-3f);
  }
}

TEST(OpacityModel, MoreOpacityAlongAnyAxisIsNeverLessDepth) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 3000; ++i) {
    const V3f d = random_direction(random), size(1, 1 + unit(random), unit(random) + 0.1f);
    V3f opacity(unit(random), unit(random), unit(random));
    const int axis = i % 3;
    float before = 0;
    for (int step = 0; step <= 20; ++step) {
      opacity[axis] = static_cast<float>(step) / 20;
      const float depth = depth_along(opacity, size, d);
      ASSERT_GE(depth, before - 1e-5f)
          << "opacity " << opacity << " along " << d << " of a box of " << size;
      before = depth;
    }
  }
}

/// Nodes with eight random boxes of random opacities each.
std::vector<BvhNode> random_nodes(std::size_t count, float greatest, bool correlated = true) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<BvhNode> nodes(count);
  for (BvhNode& node : nodes) {
    set_grid(node, Box3f(V3f(-1, 0, 2), V3f(3, 1, 4)));
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      Box3f box(V3f(-1 + 4 * unit(random), unit(random), 2 + 2 * unit(random)));
      box.extendBy(V3f(-1 + 4 * unit(random), unit(random), 2 + 2 * unit(random)));
      set_child_box(node, slot, box);
      V3f opacity;
      for (int a = 0; a < 3; ++a) opacity[a] = std::min(1.0f, greatest * unit(random));
      NormalMoments normals;
      for (int i = 0; correlated && i < 3; ++i)
        normals.add(V3f(unit(random), unit(random) - 0.5f, 0.5f - unit(random)), 1);
      set_child_opacity(node, slot, {opacity, normals}, child_box(node, slot));
    }
  }
  return nodes;
}

/// The scalar model over a mean chord of what child `slot` stores.
float stored_depth(const BvhNode& node, unsigned slot, const V3f& d) {
  const V3f size = child_box(node, slot).max - child_box(node, slot).min;
  float depth[3], correlation[3];
  for (int axis = 0; axis < 3; ++axis) {
    depth[axis] = depth_decode(node.depth[axis][slot]);
    correlation[axis] = std::copysign(1.0f, d[axis] * d[(axis + 1) % 3]) *
                        correlation_decode(node.correlation[axis][slot]);
  }
  return chord_depth(box_depth(depth[0], depth[1], depth[2], correlation[0], correlation[1],
                               correlation[2], size.y * size.z * std::fabs(d.x),
                               size.z * size.x * std::fabs(d.y), size.x * size.y * std::fabs(d.z)),
                     1.0f);
}

std::vector<float> device_depths(const std::vector<BvhNode>& nodes,
                                 const std::vector<V3f>& directions, float chords) {
  using namespace kernel_test;
  const Buffer results = device().allocate(nodes.size() * 8 * sizeof(float));
  kernel_test::run(
      "footprint_depth", "depths", nodes.size(),
      {upload(nodes), upload(directions), results, chords, static_cast<uint>(nodes.size())});
  return download<float>(results, nodes.size() * 8);
}

std::vector<V3f> random_directions(std::size_t count) {
  std::mt19937 random(5);
  std::vector<V3f> directions;
  for (std::size_t i = 0; i < count; ++i) directions.push_back(random_direction(random));
  return directions;
}

TEST(OpacityModel, TheVectorizedModelEqualsTheScalarOneOverAMeanChord) {
  const auto directions = random_directions(500);
  // Up to 1.3, cut at 1, so that full boxes are met.
  for (const float greatest : {0.5f, 1.3f}) {
    const auto nodes = random_nodes(500, greatest);
    const auto depths = device_depths(nodes, directions, 1);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
        const float expected = stored_depth(nodes[n], slot, directions[n]);
        // Twenty roundings on either side; cancellation where correlations take most away.
        ASSERT_NEAR(std::exp(-depths[8 * n + slot]), std::exp(-expected), 2e-5f)
            << "along " << directions[n];
      }
    }
  }
}

TEST(OpacityModel, TheShortLogarithmIsWithin1e5OfTheResult) {
  using namespace kernel_test;
  std::vector<float> values;
  for (int i = 0; i < 40000; ++i)
    values.push_back(std::pow(10.0f, -4.0f * static_cast<float>(i) / 40000));
  // Close to 1, where thin nodes are.
  for (int i = 1; i <= 8000; ++i) values.push_back(1 - static_cast<float>(i) * 0x1p-24f);
  const Buffer results = device().allocate(values.size() * sizeof(float));
  const auto items = static_cast<uint>(values.size() / 8);
  kernel_test::run("footprint_depth", "minus_logs", items, {upload(values), results, items});
  const auto logs = download<float>(results, values.size());
  EXPECT_EQ(logs[0], 0.0f);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double expected = -std::log(static_cast<double>(values[i]));
    ASSERT_NEAR(logs[i], expected, 1e-5 * expected + 1e-12) << values[i];
  }
}

TEST(OpacityModel, ASparseBoxsDepthGrowsWithTheChordUpToALimitAndAFullOneDoesNot) {
  const auto directions = random_directions(200);
  const auto sparse = random_nodes(200, 0.5f);
  const auto one = device_depths(sparse, directions, 1),
             half = device_depths(sparse, directions, 0.5f),
             nine = device_depths(sparse, directions, 9),
             ninety = device_depths(sparse, directions, 90);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(half[i], 0.5f * one[i], 1e-5f + 1e-4f * one[i]);
    // The longest chord of a box is one to three mean chords, by direction.
    EXPECT_EQ(nine[i], ninety[i]);
    EXPECT_GE(nine[i], one[i] * (1 - 1e-4f));
    EXPECT_LE(nine[i], 3 * one[i] * (1 + 1e-4f) + 1e-5f);
  }
  // Correlated normals may leave a way through even where every face is full.
  const auto full = random_nodes(200, 1e6f, false);
  const auto short_way = device_depths(full, directions, 0.5f),
             long_way = device_depths(full, directions, 2);
  for (std::size_t i = 0; i < short_way.size(); ++i) EXPECT_NEAR(short_way[i], long_way[i], 1e-5f);
}

TEST(OpacityModel, CentreWeightsKeepTheMeanDepthOfRaysThatFillTheBox) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const float mass_concentration : {1 / 3.0f, 2 / 3.0f, 1.0f}) {
    for (int d = 0; d < 20; ++d) {
      const V3f direction = random_direction(random);
      double weights = 0;
      constexpr int kPoints = 20000;
      // Points that fill the box pick rays by their length inside, as depths count them.
      for (int i = 0; i < kPoints; ++i) {
        const V3f p(unit(random), unit(random), unit(random));
        float enter = -100, leave = 100;
        for (int axis = 0; axis < 3; ++axis) {
          const float a = (-1 - p[axis]) / direction[axis], b = (1 - p[axis]) / direction[axis];
          enter = std::max(enter, std::min(a, b));
          leave = std::min(leave, std::max(a, b));
        }
        weights +=
            centre_weight(mass_concentration, (p + direction * (0.5f * (enter + leave))).length2());
      }
      // 0.667 to 0.707 off centre in the mean, 0.68 in the model; and the least weight.
      EXPECT_NEAR(weights / kPoints, 1, 0.045 * mass_concentration + 0.005) << direction;
    }
  }
}

TEST(OpacityModel, ThingsAcrossTheMiddleOfABoxAreFoundConcentrated) {
  CoverageMap middle, even = uniform_map({0.3f, 0.3f, 0.3f}), corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 4; row < 12; ++row) {
      for (int column = 4; column < 12; ++column)
        middle.transmittance[axis][row * kMapSize + column] = 0.2f;
    }
    for (const int cell : {0, kMapSize - 1, kMapCells - kMapSize, kMapCells - 1})
      corners.transmittance[axis][cell] = 0.2f;
  }
  const Box3f box(V3f(0, 0, 0), V3f(1, 2, 3));
  EXPECT_EQ(map_opacity(middle, {}, box).mass_concentration, 1);
  EXPECT_NEAR(map_opacity(even, {}, box).mass_concentration, 0, 0.02f);
  EXPECT_EQ(map_opacity(corners, {}, box).mass_concentration, 0);
}

}  // namespace
}  // namespace dapple
