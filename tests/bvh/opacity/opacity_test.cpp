// The model of directional opacity: the opacity and optical depth of a box along any direction, and
// the kernels' version of the model, which computes eight boxes at once (footprint.clh). Tests of
// what nodes store are in quantize_opacity_test.cpp.
#include "dapple/shared/opacity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bvh/build/object_bvh.hpp"
#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/quantize_opacity.hpp"
#include "support/random_direction.hpp"
#include "support/test_kernel.hpp"

namespace dapple {
namespace {

/// Optical depth of a box of `size` along the unit direction `d`, with uncorrelated normals.
float depth_along(const V3f& opacity, const V3f& size, const V3f& d) {
  return box_depth(depth_of(opacity.x), depth_of(opacity.y), depth_of(opacity.z), 0, 0, 0,
                   size.y * size.z * std::fabs(d.x), size.z * size.x * std::fabs(d.y),
                   size.x * size.y * std::fabs(d.z));
}

/// Random content of a box: surfaces with two random normals, and opacities up to 0.999, whose
/// transmittance is above the stored minimum.
NodeOpacity random_opacity(std::mt19937& random) {
  std::uniform_real_distribution<float> part(0.0f, 0.999f);
  NodeOpacity opacity;
  for (int axis = 0; axis < 3; ++axis) opacity.axes[axis] = part(random);
  opacity.normals.add(random_direction(random), part(random));
  opacity.normals.add(random_direction(random), part(random));
  return opacity;
}

TEST(OpacityModel, AClumpOccludesItsEllipsoidsAreaFromAnyDirection) {
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
    // A dozen operations round; the root of a difference doubles their error.
    EXPECT_NEAR(opacity_along(clump, size, d), std::min(1.0f, expected), 1e-5f);
  }
}

TEST(OpacityModel, UniformlySpreadContentsOccludeTheirOpacityAlongEachAxis) {
  for (const float opacity : {0.0f, 0.001f, 0.3f, 0.7f, 0.99f, 0.9999f}) {
    NodeOpacity uniform;
    uniform.axes = V3f(opacity);
    for (int axis = 0; axis < 3; ++axis) {
      V3f direction(0.0f);
      direction[axis] = -2;
      // The exponential has a relative error of 4e-6.
      EXPECT_NEAR(opacity_along(uniform, V3f(1, 2, 3), direction), opacity, 4e-6f);
    }
  }
}

TEST(OpacityModel, DepthsOfUniformlySpreadContentsNeedNoFactor) {
  std::mt19937 random(4);
  // An opacity has an error of 4e-6 of the transmittance. The factor divides this error by the
  // slope, which is also small for dense boxes.
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
    clump.mass.concentration = part(random);
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

/// Sums over random directions: the projected area that a clump occludes (`wanted`), the area that
/// the same content occludes if it is spread uniformly (`given`), and the derivative of `given` by
/// a factor on optical depths (`change`).
struct OccludedArea {
  double wanted = 0, given = 0, change = 0;
};

OccludedArea occluded_area(const NodeOpacity& clump, const V3f& size, std::mt19937& random) {
  constexpr float kStep = 0.01f;
  const auto with_factor = [&](float factor) {
    NodeOpacity uniform = clump;
    uniform.clumping = 0;
    for (int axis = 0; axis < 3; ++axis)
      uniform.axes[axis] = 1.0f - std::exp(-factor * depth_of(clump.axes[axis]));
    return uniform;
  };
  const NodeOpacity less = with_factor(1 - kStep), uniform = with_factor(1),
                    more = with_factor(1 + kStep);
  OccludedArea occluded;
  for (int i = 0; i < 400; ++i) {
    const V3f d = random_direction(random);
    const double facing = size.y * size.z * std::fabs(d.x) + size.z * size.x * std::fabs(d.y) +
                          size.x * size.y * std::fabs(d.z);
    occluded.wanted += facing * opacity_along(clump, size, d);
    occluded.given += facing * opacity_along(uniform, size, d);
    occluded.change +=
        facing * (opacity_along(more, size, d) - opacity_along(less, size, d)) / (2 * kStep);
  }
  return occluded;
}

TEST(OpacityModel, FactorsCorrectTheLowerMeanOcclusionOfClumps) {
  std::mt19937 random(6);
  double factors = 0, expected = 0;
  for (int i = 0; i < 500; ++i) {
    NodeOpacity clump = random_opacity(random);
    clump.clumping = 0.3f;
    const V3f size(1, 2, 1.5f);
    const OccludedArea occluded = occluded_area(clump, size, random);
    factors += clumping_factor(clump, size) - 1;
    expected += (occluded.wanted - occluded.given) / occluded.change;
  }
  EXPECT_LT(expected, -0.02 * 500) << "the case does not test much";
  // clumping_factor() integrates over seven directions, here with an error of 3 %. If the diagonals
  // had the weights of the axes, the error would be 11 %.
  EXPECT_NEAR(factors / expected, 1, 0.05);
}

TEST(OpacityModel, ASolidBoxIsOpaqueInEveryDirection) {
  std::mt19937 random(1);
  for (const V3f& size : {V3f(1, 1, 1), V3f(1, 3, 0.2f), V3f(1, 0.01f, 1)}) {
    for (int i = 0; i < 1000; ++i) {
      const float depth = depth_along(V3f(1, 1, 1), size, random_direction(random));
      // The minimum transmittance is 1e-4, in the worst case to the power of 1 / sqrt(3): 0.0049.
      EXPECT_LT(std::exp(-depth), 0.005f);
    }
  }
}

TEST(OpacityModel, ASheetSeenFaceOnHasItsOwnOpacity) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float opacity : {0.01f, 0.3f, 0.7f, 0.93f, 0.99f}) {
      V3f opacities(0.0f), size(2, 3, 4), direction(0.0f);
      opacities[axis] = opacity;
      size[axis] = 0;
      direction[axis] = -1;
      EXPECT_NEAR(1 - std::exp(-depth_along(opacities, size, direction)), opacity, 1e-5f);
      // Seen edge-on, the sheet has no area that a ray can hit.
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
    // -log(1 - x) = x + x^2 / 2: the ratio's error is x / 2, for x up to 4e-3. Rounding adds
    // 1e-7 / x.
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

/// Nodes with eight random boxes each. Their opacities are random, up to `greatest`, but at most 1.
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

/// Optical depth over a mean chord of child `slot`, by the scalar model from the stored codes.
float stored_depth(const BvhNode& node, unsigned slot, const V3f& d) {
  const V3f size = child_box(node, slot).max - child_box(node, slot).min;
  float depth[3], correlation[3];
  for (int axis = 0; axis < 3; ++axis) {
    depth[axis] = decode_depth(node.depth[axis][slot]);
    correlation[axis] = std::copysign(1.0f, d[axis] * d[(axis + 1) % 3]) *
                        decode_correlation(node.correlation[axis][slot]);
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
  // Opacities of up to 1.3 are clamped to 1, so that some boxes are full.
  for (const float greatest : {0.5f, 1.3f}) {
    const auto nodes = random_nodes(500, greatest);
    const auto depths = device_depths(nodes, directions, 1);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
        const float expected = stored_depth(nodes[n], slot, directions[n]);
        // Both sides round about twenty times. Where correlations subtract most of the depth,
        // cancellation increases the error.
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
  // Values close to 1, as in thin nodes.
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
    // The longest chord of a box is one to three mean chords, depending on the direction.
    EXPECT_EQ(nine[i], ninety[i]);
    EXPECT_GE(nine[i], one[i] * (1 - 1e-4f));
    EXPECT_LE(nine[i], 3 * one[i] * (1 + 1e-4f) + 1e-5f);
  }
  // Without correlated normals, with which rays may pass between surfaces even if all faces are
  // full.
  const auto full = random_nodes(200, 1e6f, false);
  const auto short_way = device_depths(full, directions, 0.5f),
             long_way = device_depths(full, directions, 2);
  for (std::size_t i = 0; i < short_way.size(); ++i) EXPECT_NEAR(short_way[i], long_way[i], 1e-5f);
}

}  // namespace
}  // namespace dapple
