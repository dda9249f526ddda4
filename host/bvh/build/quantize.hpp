// Child boxes to 8 bits a bound and back. Quantization may grow a box, never shrink it.
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

/// Of a coordinate: two roundings to a float. Kernels round a stored side to a float, which leaves
/// it at least as far outside as a float can say, and then multiply it and the ray's origin by the
/// inverse direction: two roundings of numbers about as large as the coordinate over the direction.
/// Where a ray has far to go to the box the rest is a part of the distance, and is paid for there.
inline constexpr double kGridRounding = 0x1p-23;

}  // namespace dapple
