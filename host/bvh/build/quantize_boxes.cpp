#include "bvh/build/quantize_boxes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace dapple {
namespace {

/// Margin of a side at `coordinate`, in steps.
double margin(float coordinate, double step) {
  return kGridMargin + kGridRounding * std::fabs(coordinate) / step;
}

/// Steps are at least 2^-100: with smaller steps box sides may be denormal numbers, which kernels
/// multiply slowly (experiment 101).
constexpr int kMinPower = -100;

/// Chooses the smallest step, a power of two, such that [lower, upper] and both margins fit in 255
/// steps from the origin, which is rounded down to a float. The search starts with the step at
/// which 253 steps suffice without margins.
void choose_axis(float lower, float upper, float& origin, uchar& exponent) {
  int power = kMinPower;
  const double size = static_cast<double>(upper) - lower;
  if (size > 0) power = std::max(power, static_cast<int>(std::ceil(std::log2(size / 253.0))));
  for (;; ++power) {
    const double step = std::ldexp(1.0, power);
    const double wanted = lower - 2.0 * margin(lower, step) * step;
    auto start = static_cast<float>(wanted);
    if (start > wanted) start = std::nextafter(start, -std::numeric_limits<float>::infinity());
    if ((upper - static_cast<double>(start)) / step + margin(upper, step) > 255.0) continue;
    origin = start;
    exponent = static_cast<uchar>(power + 127);
    return;
  }
}

}  // namespace

void set_grid(BvhNode& node, const Box3f& box) {
  for (int axis = 0; axis < 3; ++axis) {
    choose_axis(box.min[axis], box.max[axis], node.origin[axis], node.exponent[axis]);
    std::fill(std::begin(node.lower[axis]), std::end(node.lower[axis]), uchar{255});
    std::fill(std::begin(node.upper[axis]), std::end(node.upper[axis]), uchar{0});
  }
}

void set_child_box(BvhNode& node, unsigned slot, const Box3f& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const double step = std::ldexp(1.0, node.exponent[axis] - 127);
    const double origin = node.origin[axis];
    const double lower = std::floor((box.min[axis] - origin) / step - margin(box.min[axis], step));
    const double upper = std::ceil((box.max[axis] - origin) / step + margin(box.max[axis], step));
    assert(lower >= -1.0 && upper <= 256.0);
    node.lower[axis][slot] = static_cast<uchar>(std::clamp(lower, 0.0, 255.0));
    node.upper[axis][slot] = static_cast<uchar>(std::clamp(upper, 0.0, 255.0));
    assert(origin + node.lower[axis][slot] * step <= box.min[axis]);
    assert(origin + node.upper[axis][slot] * step >= box.max[axis]);
  }
}

Box3f child_box(const BvhNode& node, unsigned slot) {
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    const float scale = bvh_scale(node.exponent[axis]);
    box.min[axis] = node.origin[axis] + static_cast<float>(node.lower[axis][slot]) * scale;
    box.max[axis] = node.origin[axis] + static_cast<float>(node.upper[axis][slot]) * scale;
  }
  return box;
}

}  // namespace dapple
