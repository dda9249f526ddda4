// Prefilters a BVH or a part of it. In: nodes with their primitives, in the arrays of the object
// or of the scene. Out: the directional opacities of the nodes. Lacewell et al., "Raytracing
// Prefiltered Occlusion for Aggregate Geometry", 2008.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/build/object_bvh.hpp"
#include "bvh/opacity/wall.hpp"
#include "bvh/refit/refit_record.hpp"

namespace dapple {

/// The result of prefiltering a subtree, as its parent needs it.
struct Summary {
  CoverageMap map;
  NormalMoments normals;
  SurfaceAreas areas;
  WallAreas walls = {};  ///< not set when an object is refitted
};

/// The nodes of an object, and the arrays that the indices in these nodes refer to.
struct ObjectArrays {
  std::span<BvhNode> nodes;  ///< of this object only
  std::span<TriangleBlock> blocks;
  std::span<const TexturedTriangle> textured;
  std::span<const std::uint8_t> closed;  ///< BuiltObject::closed, for the blocks of this object
  /// Indices of the object's first node, block and textured triangle in the scene's arrays; 0 if
  /// these are the arrays of the object alone.
  std::uint32_t first_node = 0, first_block = 0, first_textured = 0;
  std::span<const SegmentBlock> segments = {};  ///< of strands, which are never refitted
  std::span<const float> interior = {};         ///< BuiltObject::interior; empty when refitting
};

/// Provides the results of subtrees that are prefiltered elsewhere. In the tree these are nodes
/// without children.
class SubtreeSummaries {
 public:
  virtual ~SubtreeSummaries() = default;
  [[nodiscard]] virtual Summary summary(std::uint32_t node) const = 0;
  /// Returns the opacity of the subtree if it was just prefiltered again; nullptr: the opacity
  /// follows from the refit record.
  [[nodiscard]] virtual const NodeOpacity* measured(std::uint32_t node) const = 0;
};

struct PrefilterTask {
  const ObjectArrays& object;
  const WideTree& tree;
  std::span<const std::uint32_t> node_of;  ///< object's index of each tree node; empty: the same
  RefitRecord* record = nullptr;           ///< stores the opacities for refitting; may be null
  const SubtreeSummaries* summaries = nullptr;
};

/// Sets the opacities of all nodes below the root of the tree. Returns the summary of the root.
Summary prefilter(const PrefilterTask& task, const TextureIntegrals& integrals);

}  // namespace dapple
