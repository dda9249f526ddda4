// The data that refitting an object needs in addition to its arrays: the triangle of each lane of
// its blocks, and opacities that motion hardly changes. Made while the object is built; about 20
// bytes a triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/opacity/coverage_map.hpp"

namespace dapple {

/// Refitting assumes that subtrees of at most this many primitives move nearly rigidly.
inline constexpr std::uint32_t kRigidPrimitives = 256;

/// For each child of a node: the occluded area relative to the surface area inside, and the
/// clumping factor. Neither changes if the content moves rigidly; both change little if it bends.
class KeptOpacity {
 public:
  /// Stores child `slot`. `axes`: opacity of the child along the axes; `areas`: of the surfaces in
  /// its `box`; `factor`: clumping_factor().
  void keep(unsigned slot, const V3f& axes, const SurfaceAreas& areas, const Box3f& box,
            float factor);
  /// Returns the occluded area of child `slot` seen along `axis`, divided by the sum of the
  /// projected areas of its surfaces.
  [[nodiscard]] float share(int axis, unsigned slot) const {
    return static_cast<float>(share_[axis][slot]) * (1.0f / kShareOne);
  }
  [[nodiscard]] float factor(unsigned slot) const {
    return 0.6f + static_cast<float>(factor_[slot]) * (1.0f / 255.0f);
  }

 private:
  /// The code of share 1: no surfaces overlap. Of n layers of opaque ones the share is 1/n.
  static constexpr float kShareOne = 43690.0f;
  std::array<std::array<std::uint16_t, DAPPLE_BVH_WIDTH>, 3> share_{};
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

/// A subtree of at most kRigidPrimitives primitives. Its parent is the root of the object or has
/// more primitives.
struct KeptSubtree {
  std::uint32_t node = 0;  ///< index of its root among the nodes of the object
  SmallMap map;
  V3f axes{0, 0, 0};    ///< its opacity along the axes when the map was made
  V3f layers{0, 0, 0};  ///< its layers_in() when the map was made

  void keep(const CoverageMap& made, const SurfaceAreas& areas, const Box3f& box);
  /// Returns the opacity along the axes if layers_in() is `layers_now`.
  [[nodiscard]] V3f axes_at(const V3f& layers_now) const;
};

struct RefitRecord {
  std::vector<std::uint32_t> triangles;  ///< for each lane of the object's blocks: index in mesh
  std::vector<std::uint8_t> closed;      ///< BuiltObject::closed
  std::vector<float> textured_opacity;   ///< mean opacity of each textured triangle
  std::vector<KeptOpacity> nodes;
  std::vector<KeptSubtree> subtrees;  ///< sorted by KeptSubtree::node
  /// The tree above the subtrees. The roots of the subtrees are nodes without children here.
  WideTree upper;
  std::vector<std::uint32_t> upper_nodes;  ///< the object's node for each node of `upper`, sorted

  /// Returns the index in `subtrees` of the subtree whose root is the object's `node`. It must
  /// exist.
  [[nodiscard]] std::size_t subtree_at(std::uint32_t node) const;
};

/// Separates the subtrees from the tree: fills `upper`, `upper_nodes` and the nodes of `subtrees`.
void cut_subtrees(const WideTree& tree, RefitRecord& record);

/// Returns, for each axis, the projected area of all surfaces (front, back and other) divided by
/// that of the box; 0 if the box has no area.
V3f layers_in(const SurfaceAreas& areas, const Box3f& box);

}  // namespace dapple
