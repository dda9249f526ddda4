// A scalar traversal on the host, to compare the kernels with. It shares only the headers of
// dapple/shared with them: decoding of nodes, the opacity model, the records. It is recursive and
// tests one child and one triangle at a time. In: a BVH without opacity textures and a ray; out:
// transmittance and counts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "bvh/build/object_bvh.hpp"
#include "dapple/bvh.hpp"
#include "dapple/options.hpp"
#include "dapple/shared/opacity.h"
#include "dapple/shared/ray.h"

namespace dapple {

class ReferenceTraversal {
 public:
  struct Result {
    float transmittance = 1;
    uint visits = 0, tests = 0;
  };

  ReferenceTraversal(const SceneBvh& bvh, Estimator estimator, float footprint)
      : bvh_(bvh), prefiltered_(estimator == Estimator::prefiltered), footprint_(footprint) {}

  [[nodiscard]] Result trace(const Ray& ray) const {
    Walk walk{ray, {}, false};
    const float scale = footprint_ * footprint_spread(ray.key);
    const Space world{{ray.origin[0], ray.origin[1], ray.origin[2]},
                      {ray.direction[0], ray.direction[1], ray.direction[2]},
                      scale * ray.first_area,
                      scale * ray.solid_angle};
    visit(walk, world, bvh_.root, bvh_.has_top);
    if (walk.result.transmittance < DAPPLE_OPAQUE_ENOUGH) walk.result.transmittance = 0;
    return walk.result;
  }

 private:
  struct Walk {
    const Ray& ray;
    Result result;
    bool finished;
  };

  /// The ray and its footprint in world or object space; t is the same in both.
  struct Space {
    V3f origin, direction;
    float first_area, solid_angle;
  };

  struct Crossing {
    bool hit = false;
    float enter = 0, leave = 0;
    V3f size, centre;  ///< of the box; the centre is relative to the ray's origin
  };

  /// The slab test of Kay and Kajiya ("Ray Tracing Complex Scenes", 1986) for one child. The far
  /// distance is enlarged as in the kernels, against roundings.
  static Crossing cross(const BvhNode& node, unsigned slot, const Space& space, float t_max) {
    Crossing crossing;
    if (node.lower[0][slot] > node.upper[0][slot]) return crossing;
    crossing.leave = t_max * 0.9999995f;
    for (int axis = 0; axis < 3; ++axis) {
      const float scale = bvh_scale(node.exponent[axis]);
      const float lower = static_cast<float>(node.lower[axis][slot]) * scale;
      const float upper = static_cast<float>(node.upper[axis][slot]) * scale;
      const float along = space.direction[axis];
      const float inverse =
          1.0f / (std::fabs(along) > 1e-18f ? along : std::copysign(1e-18f, along));
      const float offset = node.origin[axis] - space.origin[axis];
      const float a = (offset + lower) * inverse, b = (offset + upper) * inverse;
      crossing.enter = std::max(crossing.enter, std::min(a, b));
      crossing.leave = std::min(crossing.leave, std::max(a, b));
      crossing.size[axis] = upper - lower;
      crossing.centre[axis] = offset + 0.5f * (lower + upper);
    }
    crossing.leave *= 1.0000005f;
    crossing.hit = crossing.enter <= crossing.leave;
    return crossing;
  }

  /// Projected areas of the child's box along `direction`: one value per pair of opposite faces.
  static V3f facing_areas(const V3f& size, const V3f& direction) {
    return {size.y * size.z * std::fabs(direction.x), size.x * size.z * std::fabs(direction.y),
            size.x * size.y * std::fabs(direction.z)};
  }

  static bool is_covered(const Crossing& c, float needed, const Space& space, float t_max) {
    return footprint_covers(needed, space.first_area, space.solid_angle, c.enter, c.leave, t_max);
  }

  /// Optical depth of a child, as box_depth(), chord_depth() and centre_weight() of opacity.h give
  /// it.
  static float depth(const BvhNode& node, unsigned slot, const Crossing& c, const V3f& facing,
                     const V3f& direction) {
    const float sum = facing.x + facing.y + facing.z;
    const float mean_chord = c.size.x * c.size.y * c.size.z / (sum + 1e-37f);
    const float longest = sum / (std::max({facing.x, facing.y, facing.z}) + 1e-37f);
    const bool thin = mean_chord <= DAPPLE_MIN_THICKNESS * c.leave;
    const float chord =
        thin ? 1.0f : std::min((c.leave - c.enter) / (mean_chord + 1e-37f), longest);
    float depths[3], correlations[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      depths[axis] = decode_depth(node.depth[axis][slot]);
      correlations[axis] = std::copysign(1.0f, direction[axis] * direction[next]) *
                           decode_correlation(node.correlation[axis][slot]);
    }
    const float weight = thin ? 1.0f : pole_weight(node, slot, c, direction);
    return weight *
           chord_depth(box_depth(depths[0], depths[1], depths[2], correlations[0], correlations[1],
                                 correlations[2], facing.x, facing.y, facing.z),
                       chord);
  }

  static float pole_weight(const BvhNode& node, unsigned slot, const Crossing& c,
                           const V3f& direction) {
    float sum = 0, square = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float pole = bvh_mass_pole(node.correlation, static_cast<uint>(axis), slot);
      const float away = (0.5f * (c.enter + c.leave) * direction[axis] - c.centre[axis]) /
                             (0.5f * c.size[axis] + 1e-37f) -
                         pole;
      sum += away * away;
      square += pole * pole;
    }
    return centre_weight(bvh_mass_concentration(node.leaf_end, slot), sum, square);
  }

  /// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.
  static bool hits(const TriangleBlock& block, unsigned lane, const Space& space, float t_max) {
    const V3f edge1 = edge_of(block, 1, lane), edge2 = edge_of(block, 2, lane);
    const V3f p = space.direction.cross(edge2);
    const float inverse = 1.0f / edge1.dot(p);
    const V3f s = space.origin - corner_of(block, 0, lane);
    const float u = s.dot(p) * inverse;
    const V3f q = s.cross(edge1);
    const float v = space.direction.dot(q) * inverse;
    const float t = edge2.dot(q) * inverse;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < t_max;
  }

  /// True when the transmittance is so small that the ray ends here.
  static bool is_opaque(Walk& walk) {
    walk.finished |= walk.result.transmittance < DAPPLE_OPAQUE_ENOUGH;
    return walk.finished;
  }

  void visit(Walk& walk, const Space& space, uint index, bool in_top) const {
    const BvhNode& node = bvh_.nodes[index];
    const float t_max = walk.ray.t_max;
    ++walk.result.visits;
    std::array<bool, DAPPLE_BVH_WIDTH> open{};
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      const Crossing crossing = cross(node, slot, space, t_max);
      open[slot] = crossing.hit;
      if (!crossing.hit || !prefiltered_) continue;
      const V3f facing = facing_areas(crossing.size, space.direction);
      if (bvh_is_wall(node.depth, slot)) continue;
      const bool leaf = !in_top && !(node.inner_mask >> slot & 1);
      const float needed = (leaf ? DAPPLE_LEAF_COVERING : 1) * (facing.x + facing.y + facing.z);
      if (!is_covered(crossing, needed, space, t_max)) continue;
      open[slot] = false;
      walk.result.transmittance *= std::exp(-depth(node, slot, crossing, facing, space.direction));
    }
    if (prefiltered_ && is_opaque(walk)) return;
    if (!in_top) test_leaves(walk, space, node, open);
    if (is_opaque(walk)) return;
    for (const bool inner : {false, true}) visit_children(walk, space, node, open, inner, in_top);
  }

  /// Visits the open children that are inner nodes, or the instances. Backwards, because the
  /// kernels' stack returns the last pushed child first; they push instances after nodes.
  void visit_children(Walk& walk, const Space& space, const BvhNode& node,
                      const std::array<bool, DAPPLE_BVH_WIDTH>& open, bool inner,
                      bool in_top) const {
    for (unsigned slot = DAPPLE_BVH_WIDTH; slot-- > 0 && !walk.finished;) {
      if (!open[slot] || (node.inner_mask >> slot & 1) != inner) continue;
      if (inner) {
        uint child = node.child_base;
        for (unsigned before = 0; before < slot; ++before) child += node.inner_mask >> before & 1;
        visit(walk, space, child, in_top);
      } else if (in_top) {
        enter(walk, space, bvh_.instances[node.prim_base + bvh_leaf_end(node.leaf_end, slot) - 1u]);
      }
    }
  }

  void test_leaves(Walk& walk, const Space& space, const BvhNode& node,
                   const std::array<bool, DAPPLE_BVH_WIDTH>& open) const {
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      if (!open[slot] || (node.inner_mask >> slot & 1)) continue;
      for (uint i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot); ++i) {
        const TriangleBlock& block = bvh_.blocks[bvh_block(node.prim_base, i)];
        const float opacity = block.opacity[i % 8];
        if (opacity < 0) std::abort();  // textured triangles are not supported here
        ++walk.result.tests;
        if (hits(block, i % 8, space, walk.ray.t_max)) walk.result.transmittance *= 1 - opacity;
      }
    }
  }

  /// Moves a ray from the world into an instance. The direction keeps its length in t.
  void enter(Walk& walk, const Space& world, const InstanceRecord& instance) const {
    if (instance.light && instance.light == walk.ray.light) return;
    const float* m = instance.to_object;
    Space object = world;
    for (int row = 0; row < 3; ++row) {
      const V3f r(m[4 * row], m[4 * row + 1], m[4 * row + 2]);
      object.direction[row] = r.dot(world.direction);
      object.origin[row] = r.dot(world.origin) + m[4 * row + 3];
    }
    object.first_area *= instance.inverse_det;
    object.solid_angle *= instance.inverse_det;
    visit(walk, object, instance.root, false);
  }

  const SceneBvh& bvh_;
  bool prefiltered_;
  float footprint_;
};

}  // namespace dapple
