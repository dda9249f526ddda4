#include "bvh/storage/object_validation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "bvh/storage/textured_triangle.hpp"
#include "scene/check/finite.hpp"

namespace dapple {
namespace {

bool leaves_are_sound(const BvhNode& node, const FinishedObject& object) {
  for (uint slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    if (bvh_leaf_begin(&node, slot) > bvh_leaf_end(node.leaf_end, slot)) return false;
  }
  const std::uint32_t primitives = bvh_leaf_end(node.leaf_end, DAPPLE_BVH_WIDTH - 1);
  const std::size_t blocks =
      node.prim_base & DAPPLE_SEGMENTS ? object.segments.size() : object.blocks.size();
  return std::uint64_t{bvh_block_index(node.prim_base)} + (primitives + 7u) / 8u <= blocks;
}

std::uint32_t children_of(const BvhNode& node) {
  std::uint32_t children = 0;
  for (uint slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    const bool leaf = bvh_leaf_begin(&node, slot) < bvh_leaf_end(node.leaf_end, slot);
    children += leaf || (node.inner_mask >> slot & 1u) != 0;
  }
  return children;
}

/// Checks the nodes and the stack size in one backward loop, like stack_needed() for wide trees.
bool nodes_are_sound(const FinishedObject& object) {
  std::vector<std::uint32_t> needed(object.nodes.size(), 0);
  for (std::size_t n = needed.size(); n-- > 0;) {
    const BvhNode& node = object.nodes[n];
    const std::uint64_t first = node.child_base;
    const auto inner = static_cast<std::uint64_t>(std::popcount(node.inner_mask));
    if (inner > 0 && (first <= n || first + inner > needed.size())) return false;
    if (!leaves_are_sound(node, object)) return false;
    std::uint32_t deepest = 1;
    for (std::uint64_t c = 0; c < inner; ++c) deepest = std::max(deepest, needed[first + c]);
    const std::uint32_t children = children_of(node);
    if (children == 0) return false;
    needed[n] = std::min(children - 1 + deepest, DAPPLE_STACK_SIZE + 1u);
  }
  return !needed.empty() && std::min(object.stack, DAPPLE_STACK_SIZE + 1u) == needed[0];
}

/// Whether all opacities are in [0,1] or refer to existing textured triangles. False for NaN.
bool blocks_are_sound(const FinishedObject& object) {
  const float min = -static_cast<float>(object.textured.size());
  const tbb::blocked_range<std::size_t> all(0, object.blocks.size(), 4096);
  return tbb::parallel_reduce(
      all, true,
      [&](const auto& range, bool sound) {
        for (std::size_t b = range.begin(); sound && b < range.end(); ++b) {
          for (const float opacity : object.blocks[b].opacity) {
            sound &= opacity >= min && opacity <= 1.0f && (opacity >= 0.0f || opacity <= -1.0f);
          }
        }
        return sound;
      },
      [](bool a, bool b) { return a && b; });
}

/// Whether radii and opacities of the blocks are valid. Planes and codes may have any value.
bool segments_are_sound(const FinishedObject& object) {
  return std::all_of(object.segments.begin(), object.segments.end(), [](const SegmentBlock& block) {
    return block.opacity >= 0.0f && block.opacity <= 1.0f && block.radius >= 0.0f;
  });
}

bool textured_are_sound(const FinishedObject& object, const Scene& scene) {
  return std::all_of(
      object.textured.begin(), object.textured.end(), [&](const TexturedTriangle& triangle) {
        const TexturedCorners corners = unpack_textured(triangle);
        if (corners.material >= scene.materials.size()) return false;
        const int texture = scene.materials[corners.material].alpha_texture;
        return !corners.has_texture ||
               (texture >= 0 && static_cast<std::size_t>(texture) < scene.textures.size());
      });
}

/// Whether each lane has a number. Those who look the primitives up compare it with the mesh.
bool primitives_are_sound(const FinishedObject& object) {
  return object.primitives.size() == 8 * (object.blocks.size() + object.segments.size());
}

bool is_share(float value) { return value >= 0.0f && value <= 1.0f; }

bool box_is_sound(const Box3f& box) {
  return box.isEmpty() || (is_finite(box.min) && is_finite(box.max));
}

/// What instances are placed with.
bool summary_is_sound(const ObjectSummary& object) {
  const NodeOpacity& opacity = object.opacity;
  const auto& moments = opacity.normals.sum;
  const V3f& pole = opacity.mass.pole;
  return !object.box.isEmpty() && box_is_sound(object.box) &&
         std::all_of(object.parts.begin(), object.parts.end(), box_is_sound) &&
         std::any_of(object.parts.begin(), object.parts.end(),
                     [](const Box3f& box) { return !box.isEmpty(); }) &&
         is_share(opacity.axes.x) && is_share(opacity.axes.y) && is_share(opacity.axes.z) &&
         is_share(opacity.clumping) && is_share(opacity.mass.concentration) &&
         std::all_of(moments.begin(), moments.end(), [](float m) { return std::isfinite(m); }) &&
         is_share(std::fabs(pole.x)) && is_share(std::fabs(pole.y)) && is_share(std::fabs(pole.z));
}

}  // namespace

bool is_sound(const FinishedObject& object, const Scene& scene) {
  return summary_is_sound(object) && nodes_are_sound(object) && blocks_are_sound(object) &&
         segments_are_sound(object) && textured_are_sound(object, scene) &&
         primitives_are_sound(object);
}

}  // namespace dapple
