// Refits the lower subtrees of an object after their triangles moved.
#pragma once

#include <array>
#include <vector>

#include "bvh/opacity/prefilter.hpp"

namespace dapple {

/// The result of a refitted subtree for its parent.
struct MovedPart {
  Box3f box;
  SurfaceAreas areas;
  NormalMoments normals;
  double half_areas = 0;  ///< half_area() of its nodes summed
};

class SubtreeRefit {
 public:
  SubtreeRefit(const Mesh& mesh, const ObjectArrays& object, const RefitRecord& record)
      : mesh_(mesh), object_(object), record_(record) {}

  /// Rewrites the triangles, boxes and opacities of the object's node `root`, which has at most
  /// kRigidPrimitives, and all below.
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

/// Boxes of inner children and of nodes with children, from those of leaves and of nodes without.
void pass_up_boxes(WideTree& tree);

/// The object's node `root` and all below as a tree of its own, with the boxes of moved triangles;
/// `node_of` gets the object's nodes that its own are.
WideTree wide_subtree(const Mesh& mesh, const ObjectArrays& object, const RefitRecord& record,
                      std::uint32_t root, std::vector<std::uint32_t>& node_of);

}  // namespace dapple
