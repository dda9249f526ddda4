#include "bvh/refit/refit_subtree.hpp"

#include <algorithm>
#include <array>

#include "bvh/build/quantize_boxes.hpp"
#include "bvh/opacity/quantize_opacity.hpp"

namespace dapple {
namespace {

bool is_inner(const BvhNode& node, unsigned slot) { return (node.inner_mask >> slot & 1u) != 0; }

bool is_leaf(const BvhNode& node, unsigned slot) {
  return bvh_leaf_begin(&node, slot) < bvh_leaf_end(node.leaf_end, slot);
}

/// Returns the index, among the object's nodes, of the first inner child.
std::uint32_t first_inner(const BvhNode& node, const ObjectArrays& object) {
  return node.child_base - object.first_node;
}

/// Returns the index, among the lanes of the object's refit record, of primitive `i` of the node's
/// leaves.
std::size_t lane_of(const BvhNode& node, const ObjectArrays& object, std::uint32_t i) {
  return 8 * std::size_t{bvh_block_index(node.prim_base) - object.first_block} + i;
}

/// Box3f::extendBy() without branches: they are hard to predict here.
void join(Box3f& box, const Box3f& other) {
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::min(box.min[axis], other.min[axis]);
    box.max[axis] = std::max(box.max[axis], other.max[axis]);
  }
}

void add(MovedPart& to, const MovedPart& part) {
  join(to.box, part.box);
  to.areas.add(part.areas);
  to.normals.add(part.normals);
  to.half_areas += part.half_areas;
}

}  // namespace

void pass_up_boxes(WideTree& tree) {
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    WideNode& node = tree.nodes[n];
    if (node.child_count == 0) continue;
    node.box.makeEmpty();
    for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
      WideChild& child = tree.children[c];
      if (child.count == 0) child.box = tree.nodes[child.first].box;
      node.box.extendBy(child.box);
    }
  }
}

MovedPart SubtreeRefit::leaf(const BvhNode& node, unsigned slot) const {
  MovedPart moved;
  const std::uint32_t end = bvh_leaf_end(node.leaf_end, slot);
  for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < end; ++i) {
    const std::size_t lane = lane_of(node, object_, i);
    const std::uint32_t triangle = record_.triangles[lane];
    TriangleBlock& block = object_.blocks[bvh_block(node.prim_base, i)];
    float opacity = block.opacity[i % 8];
    set_lane(block, i % 8, mesh_, triangle, opacity);
    join(moved.box, triangle_box(mesh_, triangle));
    if (opacity < 0.0f) {
      opacity =
          record_
              .textured_opacity[static_cast<std::size_t>(-opacity - 1.0f) - object_.first_textured];
    }
    const V3f area = 0.5f * edge_of(block, 1, i % 8).cross(edge_of(block, 2, i % 8));
    const bool closed = !record_.closed.empty() && (record_.closed[lane / 8] >> lane % 8 & 1u) != 0;
    moved.areas.add(area, opacity, closed);
    moved.normals.add(area, opacity);
  }
  return moved;
}

MovedPart SubtreeRefit::subtree(std::uint32_t root) const {
  prefetch(root);
  return node(root);
}

// The triangles of a subtree are scattered over the mesh. Without prefetching, their
// cache misses would be sequential: experiment 106.
void SubtreeRefit::prefetch(std::uint32_t root) const {
  std::array<std::uint32_t, kRigidPrimitives> triangles;
  std::size_t count = 0;
  find_triangles(root, triangles, count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t* index = &mesh_.indices[3 * std::size_t{triangles[i]}];
    for (int corner = 0; corner < 3; ++corner) __builtin_prefetch(&mesh_.positions[index[corner]]);
  }
}

void SubtreeRefit::find_triangles(std::uint32_t index,
                                  std::array<std::uint32_t, kRigidPrimitives>& triangles,
                                  std::size_t& count) const {
  const BvhNode& node = object_.nodes[index];
  const std::uint32_t own = bvh_leaf_end(node.leaf_end, DAPPLE_BVH_WIDTH - 1);
  for (std::uint32_t i = bvh_first_lane(node.prim_base); i < own; ++i) {
    const std::uint32_t triangle = record_.triangles[lane_of(node, object_, i)];
    __builtin_prefetch(&mesh_.indices[3 * std::size_t{triangle}]);
    triangles[count++] = triangle;
  }
  std::uint32_t inner = first_inner(node, object_);
  for (unsigned mask = node.inner_mask; mask; mask &= mask - 1)
    find_triangles(inner++, triangles, count);
}

MovedPart SubtreeRefit::node(std::uint32_t index) const {
  BvhNode& node = object_.nodes[index];
  std::array<MovedPart, DAPPLE_BVH_WIDTH> children;
  MovedPart all;
  std::uint32_t inner = first_inner(node, object_);
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    if (is_inner(node, slot)) {
      children[slot] = this->node(inner++);
    } else if (is_leaf(node, slot)) {
      children[slot] = leaf(node, slot);
    } else {
      continue;
    }
    add(all, children[slot]);
  }
  all.half_areas += half_area(all.box);
  set_grid(node, all.box);
  for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    const MovedPart& child = children[slot];
    if (child.box.isEmpty()) continue;
    set_child_box(node, slot, child.box);
    set_kept_opacity(node, slot, record_.nodes[index], child.areas, child.normals, child.box);
  }
  return all;
}

WideTree wide_subtree(const Mesh& mesh, const ObjectArrays& object, const RefitRecord& record,
                      std::uint32_t root, std::vector<std::uint32_t>& node_of) {
  WideTree tree;
  node_of = {root};
  // Siblings are contiguous and follow their parents, as in the object.
  for (std::size_t n = 0; n < node_of.size(); ++n) {
    const BvhNode& node = object.nodes[node_of[n]];
    WideNode wide;
    wide.first_child = static_cast<std::uint32_t>(tree.children.size());
    std::uint32_t inner = first_inner(node, object);
    for (unsigned slot = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
      WideChild child;
      if (is_inner(node, slot)) {
        child.first = static_cast<std::uint32_t>(node_of.size());
        node_of.push_back(inner++);
      } else if (is_leaf(node, slot)) {
        const std::uint32_t begin = bvh_leaf_begin(&node, slot);
        child.count = bvh_leaf_end(node.leaf_end, slot) - begin;
        for (std::uint32_t i = begin; i < begin + child.count; ++i)
          child.box.extendBy(triangle_box(mesh, record.triangles[lane_of(node, object, i)]));
        wide.primitives += child.count;
      } else {
        continue;
      }
      tree.children.push_back(child);
      ++wide.child_count;
    }
    tree.nodes.push_back(wide);
  }
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {
    for (const WideChild& child : tree.children_of(tree.nodes[n]))
      if (child.count == 0) tree.nodes[n].primitives += tree.nodes[child.first].primitives;
  }
  pass_up_boxes(tree);
  return tree;
}

}  // namespace dapple
