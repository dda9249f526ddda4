// Quantizes child boxes to 8 bits a bound, and decodes them. A box may grow, but never shrinks.
#pragma once

#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

/// Sets the node's origin and exponents to a grid of 255 steps an axis around `box`
/// (finite, not empty), and marks every slot empty.
void set_grid(BvhNode& node, const Box3f& box);

/// Stores `box`, which lies inside the grid's box, as child `slot`, grown to grid steps plus at
/// least kGridMargin of a step and kGridRounding of a side's coordinate, which pay for the kernels'
/// rounding.
void set_child_box(BvhNode& node, unsigned slot, const Box3f& box);

/// The grown box of child `slot`, as the kernels see it.
Box3f child_box(const BvhNode& node, unsigned slot);

inline constexpr double kGridMargin = 1.0 / 1024.0;

/// Margin relative to the coordinate: two roundings to a float. Kernels multiply a side and the
/// ray's origin by the inverse direction, which rounds two numbers of the size of the coordinate.
/// Errors relative to the distance are covered by the slab test's own margin.
inline constexpr double kGridRounding = 0x1p-23;

}  // namespace dapple
