// The data that refitting an object needs beside its arrays: the triangle of each lane, and
// opacities that motion hardly changes. Made while the object is built; about 16 bytes a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/opacity/coverage_map.hpp"

namespace dapple {

/// Subtrees of up to so many primitives are taken to move nearly rigidly.
inline constexpr std::uint32_t kRigidPrimitives = 256;

/// For a node's children: opacity relative to the surface area inside, and correlations of normals.
/// Neither changes while the content moves rigidly, and both change little while it bends.
class KeptOpacity {
 public:
  /// `axes`: the child's opacity; `areas` of the surfaces in its `box`; `factor`:
  /// clumping_factor().
  void keep(unsigned slot, const V3f& axes, const SurfaceAreas& areas, const Box3f& box,
            float factor);
  /// The occluded area of child `slot` seen along `axis`, over the sum of its surfaces' areas.
  [[nodiscard]] float share(int axis, unsigned slot) const {
    return static_cast<float>(share_[axis][slot]) * (1.0f / kShareOne);
  }
  [[nodiscard]] float factor(unsigned slot) const {
    return 0.6f + static_cast<float>(factor_[slot]) * (1.0f / 255.0f);
  }

 private:
  /// The code of 1: no surfaces overlap.
  static constexpr float kShareOne = 170.0f;
  std::array<std::array<std::uint8_t, DAPPLE_BVH_WIDTH>, 3> share_{};
  std::array<std::uint8_t, DAPPLE_BVH_WIDTH> factor_{};
};

/// A coverage map with a quarter of the cells, a byte each.
class SmallMap {
 public:
  SmallMap() = default;
  explicit SmallMap(const CoverageMap& map);
  /// Returns the map with opacities scaled so that their means are `axes`, as far as opaque cells
  /// permit.
  [[nodiscard]] CoverageMap with_means(const V3f& axes) const;

 private:
  static constexpr int kSize = kMapSize / 2;
  std::array<std::array<std::uint8_t, std::size_t{kSize} * kSize>, 3> opacity_{};
};

/// A subtree of at most kRigidPrimitives below the root or a node of more.
struct KeptSubtree {
  std::uint32_t node = 0;  ///< its root, counted from the object's
  SmallMap map;
  V3f axes{0, 0, 0};    ///< its opacity along the axes as the map was made
  V3f layers{0, 0, 0};  ///< layers_in() it then

  void keep(const CoverageMap& made, const SurfaceAreas& areas, const Box3f& box);
  /// Its opacity now that there are `layers_now`.
  [[nodiscard]] V3f axes_at(const V3f& layers_now) const;
};

struct RefitRecord {
  std::vector<std::uint32_t> triangles;  ///< by lane of the object's blocks: index in the mesh
  std::vector<std::uint8_t> closed;      ///< BuiltObject::closed
  std::vector<float> textured_opacity;   ///< mean of each textured triangle
  std::vector<KeptOpacity> nodes;
  std::vector<KeptSubtree> subtrees;  ///< in the order of their nodes
  /// The tree above the subtrees, which are nodes without children here.
  WideTree upper;
  std::vector<std::uint32_t> upper_nodes;  ///< the object's node for each of them, ascending

  /// Of the subtree whose root is the object's `node`; must be there.
  [[nodiscard]] std::size_t subtree_at(std::uint32_t node) const;
};

/// Cuts off the subtrees: fills `upper`, `upper_nodes` and the subtrees' nodes.
void cut_subtrees(const WideTree& tree, RefitRecord& record);

/// Projected areas of all surfaces, front, back and other, over those of the box; 0 where it has
/// none.
V3f layers_in(const SurfaceAreas& areas, const Box3f& box);

}  // namespace dapple
