// How a rect light given by its normal is turned about it: the one place that says so.
#pragma once

#include "dapple/scene.hpp"

namespace dapple {

/// Unit vectors along a rect's first and second edge.
struct RectAxes {
  V3f u;
  V3f v;
};

/// First axis normalize(cross(normal, +Y)), or +X where that vanishes; second axis
/// cross(normal, first). `normal` is of unit length.
inline RectAxes rect_axes(V3f normal) {
  const V3f across = normal.cross(V3f(0, 1, 0));
  const V3f u = across.length() > 1e-6f ? across.normalized() : V3f(1, 0, 0);
  return {u, normal.cross(u)};
}

}  // namespace dapple
