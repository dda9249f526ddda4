// Directional opacity, bottom-up: leaves are drawn into coverage maps of their own, and
// each node puts its children's maps into one that it hands to its parent.
#include <tbb/parallel_for.h>

#include <cmath>

#include "bvh/object_bvh.hpp"
#include "bvh/quantize.hpp"
#include "dapple/shared/opacity.h"

namespace dapple {
namespace {

/// Subtrees of fewer primitives are not worth a task.
constexpr std::uint32_t kTaskPrimitives = 2048;

/// From here on up to 1, nodes count as parts of something solid.
constexpr float kNearlySolid = 0.9f;

uchar encode_depth(float depth) {
  return static_cast<uchar>(std::lround(std::sqrt(depth / DAPPLE_GREATEST_DEPTH) * 255.0f));
}

/// What a subtree hands to its parent.
struct Summary {
  CoverageMap map;
  NormalMoments normals;
  SurfaceAreas areas;
  [[nodiscard]] NodeOpacity opacity() const { return map_opacity(map, normals); }
};

class Prefilter {
 public:
  Prefilter(BuiltObject& built, const TextureIntegrals& integrals)
      : object_(built.object), tree_(built.tree), closed_(built.closed), integrals_(integrals) {}

  Summary node(std::uint32_t index) {
    const std::uint32_t count = tree_.nodes[index].child_count;
    NodeCoverage coverage(tree_.nodes[index].box);
    NormalMoments normals;
    const auto add = [&](unsigned slot, const Summary& child) {
      const Box3f& box = tree_.children_of(tree_.nodes[index])[slot].box;
      coverage.add(child.map, box, child.areas);
      normals.add(child.normals);
      set_child_opacity(object_.nodes[index], slot, child.opacity(), box);
    };
    if (tree_.nodes[index].primitives > kTaskPrimitives) {
      std::array<Summary, DAPPLE_BVH_WIDTH> children;
      tbb::parallel_for(0u, count, [&](unsigned slot) { children[slot] = child(index, slot); });
      // Put in by slot, so that the bits don't depend on which task came first.
      for (unsigned slot = 0; slot < count; ++slot) add(slot, children[slot]);
    } else {
      for (unsigned slot = 0; slot < count; ++slot) add(slot, child(index, slot));
    }
    return {coverage.map(), normals, coverage.areas()};
  }

 private:
  Summary child(std::uint32_t index, unsigned slot) {
    const WideChild& child = tree_.children_of(tree_.nodes[index])[slot];
    return child.count ? leaf(object_.nodes[index], slot, child.box) : node(child.first);
  }

  Summary leaf(const BvhNode& node, unsigned slot, const Box3f& box) const {
    std::array<CoveringTriangle, 64> triangles;
    std::size_t count = 0;
    Summary summary;
    for (std::uint32_t i = bvh_leaf_begin(node.leaf_end, slot); i < node.leaf_end[slot]; ++i) {
      const TriangleBlock& block = object_.blocks[node.prim_base + i / 8];
      const unsigned lane = i % 8;
      const auto at = [lane](const float(&v)[3][8]) {
        return V3f(v[0][lane], v[1][lane], v[2][lane]);
      };
      const CoveringTriangle triangle{at(block.vertex), at(block.edge1), at(block.edge2),
                                      block.opacity[lane], is_closed(node.prim_base + i / 8, lane)};
      const float opacity = triangle.opacity >= 0.0f
                                ? triangle.opacity
                                : mean_opacity(triangle, 1.0f / 3, 1.0f / 3, 1.0f);
      const V3f area = 0.5f * triangle.edge1.cross(triangle.edge2);
      summary.normals.add(area, opacity);
      summary.areas.add(area, opacity, triangle.closed);
      triangles[count++] = triangle;
    }
    cover(summary.map, box, std::span(triangles.data(), count),
          [&](const CoveringTriangle& t, float u, float v, float share) {
            return mean_opacity(t, u, v, share);
          });
    return summary;
  }

  bool is_closed(std::uint32_t block, unsigned lane) const {
    return !closed_.empty() && (closed_[block] >> lane & 1u) != 0;
  }

  float mean_opacity(const CoveringTriangle& triangle, float u, float v, float share) const {
    const auto textured = static_cast<std::size_t>(-triangle.opacity - 1.0f);
    return integrals_.mean(object_.textured[textured], u, v, share);
  }

  ObjectBvh& object_;
  const WideTree& tree_;
  const std::vector<std::uint8_t>& closed_;
  const TextureIntegrals& integrals_;
};

}  // namespace

NodeOpacity map_opacity(const CoverageMap& map, const NormalMoments& normals) {
  return {V3f(map.mean_opacity(0), map.mean_opacity(1), map.mean_opacity(2)), normals,
          map.clumping()};
}

void set_child_opacity(BvhNode& node, unsigned slot, const NodeOpacity& opacity,
                       const Box3f& exact) {
  const Box3f box = child_box(node, slot);
  NodeOpacity grown = opacity;
  for (int axis = 0; axis < 3; ++axis) {
    const float area = face_area(box, axis);
    const float share = area > 0.0f ? std::min(face_area(exact, axis) / area, 1.0f) : 0.0f;
    // A solid part of a wall must not leak where its box grew: its neighbours are there.
    const float solid =
        std::clamp((opacity.axes[axis] - kNearlySolid) / (1.0f - kNearlySolid), 0.0f, 1.0f);
    grown.axes[axis] *= share + solid * (1.0f - share);
  }
  const float factor = clumping_factor(grown, box.max - box.min);
  const V3f correlation = opacity.normals.correlation();
  for (int axis = 0; axis < 3; ++axis) {
    node.depth[axis][slot] =
        encode_depth(std::min(factor * depth_of(grown.axes[axis]), DAPPLE_GREATEST_DEPTH));
    node.correlation[axis][slot] = static_cast<schar>(std::lround(127.0f * correlation[axis]));
  }
}

void prefilter(BuiltObject& built, const TextureIntegrals& integrals) {
  built.object.opacity = Prefilter(built, integrals).node(0).opacity();
}

}  // namespace dapple
