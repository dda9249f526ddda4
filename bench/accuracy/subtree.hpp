// The nodes whose opacity is measured: child slots of the object BVHs. In: a BVH. Out: the
// triangles and segments below each child, as a separate scene for reference rays.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "bvh/storage/strand_segment.hpp"
#include "dapple/bvh.hpp"

namespace dapple::bench {

/// Child `slot` of node `node`, and the number of triangles or segments below it.
struct Subtree {
  std::uint32_t node;
  unsigned slot;
  std::size_t triangles;
};

inline constexpr bool is_inner(const BvhNode& node, unsigned slot) {
  return (node.inner_mask >> slot & 1u) != 0;
}

/// Index of the node of inner child `slot`.
std::uint32_t child_node(const BvhNode& node, unsigned slot);

/// Roots of the object BVHs, without duplicates.
std::vector<std::uint32_t> object_roots(const SceneBvh& bvh);

/// Every child slot of every object that has triangles or segments below it; children before
/// parents.
std::vector<Subtree> list_subtrees(const SceneBvh& bvh);

/// One triangle of a leaf. `opacity` in [0,1], or -(1 + index) into SceneBvh::textured.
struct LeafTriangle {
  V3f vertex, edge1, edge2;
  float opacity;
};

/// Triangles of leaf child `slot` of the node.
std::vector<LeafTriangle> leaf_triangles(const SceneBvh& bvh, const BvhNode& node, unsigned slot);

/// Segments of leaf child `slot` of the node.
std::vector<StrandSegment> leaf_segments(const SceneBvh& bvh, const BvhNode& node, unsigned slot);

/// All segments below the child, in the order of the leaves.
std::vector<StrandSegment> segments_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot);

/// All triangles below the child, in the order of the leaves.
std::vector<LeafTriangle> triangles_below(const SceneBvh& bvh, const BvhNode& node, unsigned slot);

/// A scene of only these triangles, in object space, with the textures of `scene`.
Scene scene_of(const std::vector<LeafTriangle>& triangles, const SceneBvh& bvh, const Scene& scene);

}  // namespace dapple::bench
