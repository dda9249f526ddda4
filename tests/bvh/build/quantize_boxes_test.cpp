// Quantized child boxes, for boxes of all sizes and positions: they contain the original box, are
// larger by about one grid step, and the grid is about as fine as 8 bits allow.
#include "bvh/build/quantize_boxes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dapple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Random boxes around `centre`, at most `size` wide along each axis. Every third box inside a
/// parent is flat along one axis.
class BoxSource {
 public:
  BoxSource(V3f centre, V3f size) : centre_(centre), size_(size) {}

  Box3f parent() { return between(corner(), corner()); }

  Box3f inside(const Box3f& box) {
    Box3f child = between(within(box), within(box));
    if (++made_ % 3 == 0) child.max[made_ / 3 % 3] = child.min[made_ / 3 % 3];
    return child;
  }

 private:
  V3f corner() {
    V3f p;
    for (int a = 0; a < 3; ++a) p[a] = centre_[a] + (unit() - 0.5f) * size_[a];
    return p;
  }
  V3f within(const Box3f& box) {
    V3f p;
    for (int a = 0; a < 3; ++a) {
      p[a] = std::clamp(box.min[a] + unit() * (box.max[a] - box.min[a]), box.min[a], box.max[a]);
    }
    return p;
  }
  static Box3f between(const V3f& a, const V3f& b) {
    Box3f box(a);
    box.extendBy(b);
    return box;
  }
  float unit() { return std::uniform_real_distribution<float>(0, 1)(random_); }

  V3f centre_, size_;
  std::mt19937 random_{7};
  int made_ = 0;
};

struct Family {
  const char* name;
  V3f centre, size;
};

const Family kFamilies[] = {
    {"ordinary", {0, 0, 0}, {10, 10, 10}},
    {"off centre", {100, -30, 7}, {2, 3, 0.5f}},
    {"far and small: the size is below a float's spacing there",
     {1e6f, -1e6f, 1e6f},
     {1e-3f, 1e-3f, 1e-3f}},
    {"flat", {1, 2, 3}, {4, 0, 5}},
    {"a line", {-5, 2, 3}, {0, 0, 5}},
    {"a point", {0.1f, 1e6f, -3e-5f}, {0, 0, 0}},
    {"tiny", {0, 0, 0}, {1e-30f, 1e-30f, 1e-30f}},
    {"denormal", {0, 0, 0}, {1e-39f, 1e-42f, 3e-45f}},
    {"of many scales", {0, 1, 0}, {1e-6f, 1, 1e6f}},
    {"huge", {0, 0, 0}, {1e37f, 1e37f, 1e37f}},
};

double step_of(const BvhNode& node, int axis) { return std::ldexp(1.0, node.exponent[axis] - 127); }

/// The child's bounds as they are stored, without the rounding of decoding to floats.
double exact_lower(const BvhNode& node, int axis, unsigned slot) {
  return node.origin[axis] + node.lower[axis][slot] * step_of(node, axis);
}
double exact_upper(const BvhNode& node, int axis, unsigned slot) {
  return node.origin[axis] + node.upper[axis][slot] * step_of(node, axis);
}

void expect_contains(const Box3f& outer, const Box3f& inner) {
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE(outer.min[a], inner.min[a]) << "axis " << a;
    EXPECT_GE(outer.max[a], inner.max[a]) << "axis " << a;
  }
}

void expect_margin_and_snug(const BvhNode& node, unsigned slot, const Box3f& box) {
  for (int a = 0; a < 3; ++a) {
    // 1e-6 of a step covers the rounding of the division, whose quotient is up to 255.
    const double step = step_of(node, a);
    const double min = (kGridMargin - 1e-6) * step;
    const double rounding_below = kGridRounding * std::fabs(box.min[a]);
    const double rounding_above = kGridRounding * std::fabs(box.max[a]);
    const double below = box.min[a] - exact_lower(node, a, slot);
    const double above = exact_upper(node, a, slot) - box.max[a];
    EXPECT_GE(below, min + 0.999999 * rounding_below) << "axis " << a;
    EXPECT_GE(above, min + 0.999999 * rounding_above) << "axis " << a;
    // A bound is rounded outward to the next step beyond the margin.
    const double max = (1 + 2 * kGridMargin) * step;
    EXPECT_LE(below, max + rounding_below) << "axis " << a;
    EXPECT_LE(above, max + rounding_above) << "axis " << a;
  }
}

/// Calls body(node, parent, boxes) for 500 boxes of each family, with the node's grid around
/// `parent`.
template <class Body>
void for_grids(const Body& body) {
  for (const Family& family : kFamilies) {
    SCOPED_TRACE(family.name);
    BoxSource boxes(family.centre, family.size);
    for (int i = 0; i < 500 && !::testing::Test::HasFailure(); ++i) {
      SCOPED_TRACE(i);
      const Box3f parent = boxes.parent();
      BvhNode node{};
      set_grid(node, parent);
      body(node, parent, boxes);
    }
  }
}

TEST(Quantize, DecodedBoundsContainTheOriginalAndGrowByAboutAStep) {
  for_grids([](BvhNode& node, const Box3f& parent, BoxSource& boxes) {
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      const Box3f child = slot == 0 ? parent : boxes.inside(parent);
      set_child_box(node, slot, child);
      expect_contains(child_box(node, slot), child);
      expect_margin_and_snug(node, slot, child);
    }
  });
}

TEST(Quantize, TheGridIsWithinTwiceTheFinestThatFits) {
  for_grids([](const BvhNode& node, const Box3f& parent, BoxSource&) {
    for (int a = 0; a < 3; ++a) {
      if (node.exponent[a] == 27) continue;  // 2^-100, the finest step
      // The origin must be a float below the box and its margin. Where floats are sparse, the
      // grid has to reach from this float to the box's end. With half the step, 255 steps may
      // just fail to cover that range.
      const auto start =
          static_cast<float>(parent.min[a] - 2 * kGridRounding * std::fabs(parent.min[a]));
      const double reach = parent.max[a] + kGridRounding * std::fabs(parent.max[a]) -
                           std::nextafter(start, -kInfinity);
      EXPECT_GT(reach, 253.0 / 4 * step_of(node, a)) << "axis " << a;
    }
  });
}

TEST(Quantize, SidesOfFlatBoxesAreNoDenormalNumbers) {
  BvhNode node{};
  const Box3f ground(V3f(-1, 0, -1), V3f(1, 0, 1));
  set_grid(node, ground);
  set_child_box(node, 0, ground);
  const Box3f grown = child_box(node, 0);
  for (const float side : {grown.min.y, grown.max.y}) {
    EXPECT_TRUE(std::isnormal(side)) << side;
    EXPECT_LT(std::fabs(side), 1e-29f);
  }
}

TEST(Quantize, EmptySlotsHaveLowerBoundsAboveUpperOnes) {
  BvhNode node{};
  set_grid(node, Box3f(V3f(0, 0, 0), V3f(1, 2, 3)));
  set_child_box(node, 3, Box3f(V3f(0, 0, 0), V3f(1, 1, 1)));
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    for (int a = 0; a < 3; ++a) {
      if (slot == 3) {
        EXPECT_LT(node.lower[a][slot], node.upper[a][slot]);
      } else {
        EXPECT_EQ(node.lower[a][slot], 255);
        EXPECT_EQ(node.upper[a][slot], 0);
      }
    }
  }
}

}  // namespace
}  // namespace dapple
