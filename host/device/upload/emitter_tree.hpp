// The triangles of a mesh light as a tree, by which kernels choose those that are near a receiver
// (Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
// 2018). In: triangles. Out: the same in the order of the tree, with its nodes
// (dapple/shared/light_record.h).
#pragma once

#include <span>
#include <vector>

#include "dapple/shared/light_record.h"

namespace dapple {

/// Divides triangles that are much longer than wide, such as those of twigs, into shorter ones: a
/// box around a long one says little of where it is. Adds at most 131,072. Of `triangles` only
/// vertex, edges and area count.
void divide_long_emitters(std::vector<EmitterTriangle>& triangles);

/// Orders the triangles of one light, of which vertex, edges and area are known, and sets the other
/// members. Nodes are divided across the longest side of the box of their triangles' centres.
/// n log n steps for n triangles.
void order_emitters(std::span<EmitterTriangle> triangles);

}  // namespace dapple
