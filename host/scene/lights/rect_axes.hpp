// The orientation of a flat light about its normal. In: the normal; out: the directions of a rect's
// two edges, or of two axes of a disk. All code that makes flat lights from a normal uses this.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Unit vectors along a rect's first and second edge.
struct RectAxes {
  V3f u;
  V3f v;
};

/// The first axis is normalize(cross(normal, +Y)), or +X where that cross product vanishes. The
/// second axis is cross(normal, first). `normal` must have unit length.
inline RectAxes rect_axes(V3f normal) {
  const V3f across = normal.cross(V3f(0, 1, 0));
  const V3f u = across.length() > 1e-6f ? across.normalized() : V3f(1, 0, 0);
  return {u, normal.cross(u)};
}

}  // namespace dapple
