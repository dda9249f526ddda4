#include "bvh/opacity/quantize_opacity.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/build/quantize_boxes.hpp"
#include "dapple/shared/opacity.h"

namespace dapple {
namespace {

/// From this opacity to 1, nodes count gradually as parts of a solid.
constexpr float kNearlySolid = 0.9f;

/// Below the code of walls.
uchar encode_depth(float depth) {
  const auto code = std::lround(std::sqrt(depth / DAPPLE_MAX_DEPTH) * 255.0f);
  return static_cast<uchar>(std::min<long>(code, DAPPLE_WALL_DEPTH - 1));
}

/// Returns the opacities of a child's quantized `box`, which is larger than its `exact` box. `axes`
/// are the opacities of the exact box.
V3f grown_opacity(const V3f& axes, const Box3f& exact, const Box3f& box) {
  V3f grown;
  for (int axis = 0; axis < 3; ++axis) {
    const float area = face_area(box, axis);
    const float share = area > 0.0f ? std::min(face_area(exact, axis) / area, 1.0f) : 0.0f;
    // Where the box of a solid part grew, it stays opaque: the neighbouring parts of the solid
    // fill that space, and light must not leak.
    const float solid = std::clamp((axes[axis] - kNearlySolid) / (1.0f - kNearlySolid), 0.0f, 1.0f);
    grown[axis] = axes[axis] * (share + solid * (1.0f - share));
  }
  return grown;
}

/// The bits of a child's mass pole along an axis; the nearest place that can be stored.
unsigned pole_code(float pole) {
  return static_cast<unsigned>(std::clamp(std::lround(2.0f * pole + 1.5f), 0L, 3L));
}

/// What a node stores of a child beside its depths and correlations.
struct StoredShape {
  unsigned opacity_variance;  ///< variance_class()
  V3f pole;                   ///< MassShape::pole
  bool wall;
};

void store_depths(BvhNode& node, unsigned slot, const V3f& axes, float factor,
                  const V3f& correlation, const StoredShape& shape) {
  for (int axis = 0; axis < 3; ++axis) {
    node.depth[axis][slot] =
        encode_depth(std::min(factor * depth_of(axes[axis]), DAPPLE_MAX_DEPTH));
    const auto code = static_cast<int>(std::lround(15.0f * correlation[axis]));
    const unsigned low = pole_code(shape.pole[axis]) << 1 | (shape.opacity_variance >> axis & 1u);
    node.correlation[axis][slot] = static_cast<schar>(code * 8 + static_cast<int>(low));
  }
  if (shape.wall) node.depth[0][slot] = DAPPLE_WALL_DEPTH;
}

}  // namespace

float set_child_opacity(BvhNode& node, unsigned slot, const NodeOpacity& opacity,
                        const Box3f& exact) {
  const Box3f box = child_box(node, slot);
  NodeOpacity grown = opacity;
  grown.axes = grown_opacity(opacity.axes, exact, box);
  const float factor = std::clamp(
      clumping_factor(grown, box.max - box.min) / opacity.mass.mean_weight(), 0.6f, 1.6f);
  store_depths(node, slot, grown.axes, factor, opacity.normals.correlation(),
               {variance_class(opacity), opacity.mass.pole, opacity.wall});
  const auto level = static_cast<unsigned>(std::lround(3.0f * opacity.mass.concentration));
  node.leaf_end[slot] = static_cast<uchar>(bvh_leaf_end(node.leaf_end, slot) | level << 6);
  return factor;
}

unsigned variance_of_child(const BvhNode& node, unsigned slot) {
  unsigned bits = 0;
  for (unsigned pair = 0; pair < 3; ++pair)
    bits |= (static_cast<unsigned>(node.correlation[pair][slot]) & 1u) << pair;
  return bits;
}

void set_kept_opacity(BvhNode& node, unsigned slot, const KeptOpacity& kept,
                      const SurfaceAreas& areas, const NormalMoments& normals, const Box3f& exact) {
  V3f axes = layers_in(areas, exact);
  for (int axis = 0; axis < 3; ++axis)
    axes[axis] = std::min(1.0f, axes[axis] * kept.share(axis, slot));
  store_depths(
      node, slot, grown_opacity(axes, exact, child_box(node, slot)), kept.factor(slot),
      normals.correlation(),
      {std::max(variance_of_child(node, slot), variance_class({axes, {}})),
       V3f(bvh_mass_pole(node.correlation, 0, slot), bvh_mass_pole(node.correlation, 1, slot),
           bvh_mass_pole(node.correlation, 2, slot)),
       bvh_is_wall(node.depth, slot)});
}

}  // namespace dapple
