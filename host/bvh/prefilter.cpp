// Directional opacity, bottom-up: leaves are drawn into coverage maps of their own, and
// each node puts its children's maps into one that it hands to its parent.
#include <tbb/parallel_for.h>

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
    NodeCoverage coverage(wide.box);
    if (wide.primitives > kTaskPrimitives) {
      add_in_parallel(index, coverage);
    } else {
      for (unsigned slot = 0; slot < wide.child_count; ++slot)
        add(index, slot, child_map(index, slot), coverage);
    }
    return coverage.map();
  }

 private:
  CoverageMap child_map(std::uint32_t index, unsigned slot) {
    const WideChild& child = tree_.nodes[index].children[slot];
    return child.count ? leaf_map(object_.nodes[index], slot, child.box) : node_map(child.first);
  }

  void add_in_parallel(std::uint32_t index, NodeCoverage& coverage) {
    const std::uint32_t count = tree_.nodes[index].child_count;
    std::array<CoverageMap, DAPPLE_BVH_WIDTH> maps;
    tbb::parallel_for(0u, count, [&](unsigned slot) { maps[slot] = child_map(index, slot); });
    // Put in by slot, so that the bits don't depend on which task came first.
    for (unsigned slot = 0; slot < count; ++slot) add(index, slot, maps[slot], coverage);
  }

  void add(std::uint32_t index, unsigned slot, const CoverageMap& map, NodeCoverage& coverage) {
    const Box3f& box = tree_.nodes[index].children[slot].box;
    const V3f opacity(map.mean_opacity(0), map.mean_opacity(1), map.mean_opacity(2));
    coverage.add(map, box);
    set_child_opacity(object_.nodes[index], slot, opacity, box);
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

  CoverageMap leaf_map(const BvhNode& node, unsigned slot, const Box3f& box) const {
    CoverageMap map;
    for_each_triangle(node, slot, [&](const CoveringTriangle& triangle) {
      cover(map, box, triangle, [&](float u, float v, float share) {
        const auto textured = static_cast<std::size_t>(-triangle.opacity - 1.0f);
        return integrals_.mean(object_.textured[textured], u, v, share);
      });
    });
    return map;
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
