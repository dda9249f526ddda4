// Directional opacity, bottom-up: each node draws its leaf triangles into its coverage
// map, multiplies its inner children's maps in, and hands the map to its parent.
#include <tbb/task_group.h>

#include <cmath>

#include "bvh/object_bvh.hpp"
#include "bvh/quantize.hpp"

namespace dapple {
namespace {

/// Subtrees of fewer primitives are not worth a task.
constexpr std::uint32_t kTaskPrimitives = 2048;

/// From here on up to 1, nodes count as parts of something solid.
constexpr float kNearlySolid = 0.9f;

uchar encode_opacity(float opacity) {
  return static_cast<uchar>(std::lround(std::sqrt(std::clamp(opacity, 0.0f, 1.0f)) * 255.0f));
}

class Prefilter {
 public:
  Prefilter(ObjectBvh& object, const WideTree& tree, const TextureIntegrals& integrals)
      : object_(object), tree_(tree), integrals_(integrals) {}

  CoverageMap node_map(std::uint32_t index) {
    const WideNode& wide = tree_.nodes[index];
    CoverageMap map;
    if (wide.primitives > kTaskPrimitives) {
      inner_children_in_parallel(index, map);
    } else {
      for (unsigned slot = 0; slot < wide.child_count; ++slot) {
        const WideChild& child = wide.children[slot];
        if (child.count == 0) add_inner(index, slot, node_map(child.first), map);
      }
    }
    for (unsigned slot = 0; slot < wide.child_count; ++slot) {
      if (wide.children[slot].count) add_leaf(index, slot, map);
    }
    return map;
  }

 private:
  void inner_children_in_parallel(std::uint32_t index, CoverageMap& map) {
    const WideNode& wide = tree_.nodes[index];
    std::array<CoverageMap, DAPPLE_BVH_WIDTH> maps;
    tbb::task_group tasks;
    for (unsigned slot = 0; slot < wide.child_count; ++slot) {
      const WideChild& child = wide.children[slot];
      if (child.count == 0)
        tasks.run([this, &maps, slot, &child] { maps[slot] = node_map(child.first); });
    }
    tasks.wait();
    // Multiplied in slot order, so that the bits don't depend on which task came first.
    for (unsigned slot = 0; slot < wide.child_count; ++slot) {
      if (wide.children[slot].count == 0) add_inner(index, slot, maps[slot], map);
    }
  }

  void add_inner(std::uint32_t index, unsigned slot, const CoverageMap& child_map,
                 CoverageMap& map) {
    const WideNode& wide = tree_.nodes[index];
    const Box3f& box = wide.children[slot].box;
    const V3f opacity(child_map.mean_opacity(0), child_map.mean_opacity(1),
                      child_map.mean_opacity(2));
    composite(map, wide.box, child_map, box);
    set_child_opacity(object_.nodes[index], slot, opacity, box);
  }

  void add_leaf(std::uint32_t index, unsigned slot, CoverageMap& map) {
    const WideNode& wide = tree_.nodes[index];
    BvhNode& node = object_.nodes[index];
    const Box3f& box = wide.children[slot].box;
    for_each_triangle(node, slot, [&](const CoveringTriangle& t) { draw(map, wide.box, t); });
    set_child_opacity(node, slot, leaf_opacity(node, slot, box), box);
  }

  template <class Visit>
  void for_each_triangle(const BvhNode& node, unsigned slot, const Visit& visit) const {
    for (std::uint32_t i = bvh_leaf_begin(node.leaf_end, slot); i < node.leaf_end[slot]; ++i) {
      const TriangleBlock& block = object_.blocks[node.prim_base + i / 8];
      const unsigned lane = i % 8;
      const auto at = [lane](const float(&v)[3][8]) {
        return V3f(v[0][lane], v[1][lane], v[2][lane]);
      };
      visit(CoveringTriangle{at(block.vertex), at(block.edge1), at(block.edge2),
                             block.opacity[lane]});
    }
  }

  void draw(CoverageMap& map, const Box3f& box, const CoveringTriangle& triangle) const {
    cover(map, box, triangle, [&](float u, float v, float share) {
      return integrals_.mean(object_.textured[static_cast<std::size_t>(-triangle.opacity - 1.0f)],
                             u, v, share);
    });
  }

  /// One triangle of uniform opacity is known in closed form; others are drawn.
  V3f leaf_opacity(const BvhNode& node, unsigned slot, const Box3f& box) const {
    V3f opacity(0.0f);
    CoverageMap map;
    bool drawn = false;
    for_each_triangle(node, slot, [&](const CoveringTriangle& t) {
      if (t.opacity < 0.0f || node.leaf_end[slot] - bvh_leaf_begin(node.leaf_end, slot) > 1) {
        draw(map, box, t);
        drawn = true;
        return;
      }
      const V3f normal = t.edge1.cross(t.edge2);
      for (int axis = 0; axis < 3; ++axis) {
        const float area = face_area(box, axis);
        opacity[axis] =
            area > 0.0f ? std::min(1.0f, 0.5f * std::fabs(normal[axis]) / area) * t.opacity : 0.0f;
      }
    });
    if (drawn) {
      for (int axis = 0; axis < 3; ++axis) opacity[axis] = map.mean_opacity(axis);
    }
    return opacity;
  }

  ObjectBvh& object_;
  const WideTree& tree_;
  const TextureIntegrals& integrals_;
};

}  // namespace

void set_child_opacity(BvhNode& node, unsigned slot, const V3f& opacity, const Box3f& exact) {
  const Box3f grown = child_box(node, slot);
  for (int axis = 0; axis < 3; ++axis) {
    const float area = face_area(grown, axis);
    const float share = area > 0.0f ? std::min(face_area(exact, axis) / area, 1.0f) : 0.0f;
    // A solid part of a wall must not leak where its box grew: its neighbours are there.
    const float solid =
        std::clamp((opacity[axis] - kNearlySolid) / (1.0f - kNearlySolid), 0.0f, 1.0f);
    node.opacity[axis][slot] = encode_opacity(opacity[axis] * (share + solid * (1.0f - share)));
  }
}

void prefilter(ObjectBvh& object, const WideTree& tree, const TextureIntegrals& integrals) {
  const CoverageMap root = Prefilter(object, tree, integrals).node_map(0);
  for (int axis = 0; axis < 3; ++axis) object.opacity[axis] = root.mean_opacity(axis);
}

}  // namespace dapple
