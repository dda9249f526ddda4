// Quantizes child boxes to 8 bits a bound, and decodes them. A box may grow, but never shrinks.
#pragma once

#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"

namespace dapple {

/// Sets the origin and the exponents of the node: a grid of 255 steps per axis around `box`, which
/// must be finite and not empty. Marks every slot as empty.
void set_grid(BvhNode& node, const Box3f& box);

/// Stores `box`, which must lie inside the box of the grid, as child `slot`. The stored box is
/// larger: at least by kGridMargin of a step and by kGridRounding of a side's coordinate, which
/// compensate for the kernels' rounding, and rounded outward to whole steps.
void set_child_box(BvhNode& node, unsigned slot, const Box3f& box);

/// Returns the stored box of child `slot`, as the kernels decode it.
Box3f child_box(const BvhNode& node, unsigned slot);

inline constexpr double kGridMargin = 1.0 / 1024.0;

/// Margin relative to the coordinate: two roundings to a float. Kernels multiply a side and the
/// ray's origin by the inverse direction, which rounds two numbers of the size of the coordinate.
/// Errors relative to the distance are covered by the slab test's own margin.
inline constexpr double kGridRounding = 0x1p-23;

}  // namespace dapple
