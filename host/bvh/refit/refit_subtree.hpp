// Refits the small subtrees of an object after its vertices moved. In: the moved mesh, the arrays
// of the object and its refit record. Out: new triangles, boxes and opacities in these arrays.
#pragma once

#include <array>
#include <vector>

#include "bvh/opacity/prefilter.hpp"

namespace dapple {

/// The result of refitting a subtree or a leaf, as its parent needs it.
struct MovedPart {
  Box3f box;
  SurfaceAreas areas;
  NormalMoments normals;
  double half_areas = 0;  ///< sum of half_area() over its nodes
};

class SubtreeRefit {
 public:
  SubtreeRefit(const Mesh& mesh, const ObjectArrays& object, const RefitRecord& record)
      : mesh_(mesh), object_(object), record_(record) {}

  /// Rewrites the triangles, boxes and opacities of the object's node `root` and of all nodes
  /// below. They have at most kRigidPrimitives primitives.
  MovedPart subtree(std::uint32_t root) const;

  /// Rewrites the triangles of a leaf.
  MovedPart leaf(const BvhNode& node, unsigned slot) const;

 private:
  MovedPart node(std::uint32_t index) const;
  void prefetch(std::uint32_t root) const;
  void find_triangles(std::uint32_t index, std::array<std::uint32_t, kRigidPrimitives>& triangles,
                      std::size_t& count) const;

  const Mesh& mesh_;
  const ObjectArrays& object_;
  const RefitRecord& record_;
};

/// Computes the boxes of inner children and of nodes that have children, from the boxes of leaves
/// and of nodes without children.
void pass_up_boxes(WideTree& tree);

/// Returns the object's node `root` and all nodes below as a separate tree, with the boxes of the
/// moved triangles. Sets `node_of` to the object's node for each node of this tree.
WideTree wide_subtree(const Mesh& mesh, const ObjectArrays& object, const RefitRecord& record,
                      std::uint32_t root, std::vector<std::uint32_t>& node_of);

}  // namespace dapple
