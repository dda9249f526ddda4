// Prefilters a tree or a part of it. In: nodes with their primitives, in the arrays of the object
// or of the scene. Out: the nodes' directional opacities (Lacewell et al. 2008).
#pragma once

#include <cstdint>
#include <span>

#include "bvh/build/object_bvh.hpp"
#include "bvh/refit/refit_record.hpp"

namespace dapple {

/// The result of a subtree for its parent.
struct Summary {
  CoverageMap map;
  NormalMoments normals;
  SurfaceAreas areas;
};

/// An object's nodes, and the arrays that their indices count in.
struct ObjectArrays {
  std::span<BvhNode> nodes;  ///< the object's own
  std::span<TriangleBlock> blocks;
  std::span<const TexturedTriangle> textured;
  std::span<const std::uint8_t> closed;  ///< BuiltObject::closed, of its own blocks
  std::uint32_t first_node = 0, first_block = 0, first_textured = 0;  ///< counted before its own
  std::span<const SegmentBlock> segments = {};  ///< of strands, which are never refitted
};

/// Provides the results of subtrees that are prefiltered elsewhere: nodes of this tree without
/// children.
class Stumps {
 public:
  virtual ~Stumps() = default;
  [[nodiscard]] virtual Summary summary(std::uint32_t node) const = 0;
  /// Its opacity as prefiltering found it just now; nullptr: by what the record kept of it.
  [[nodiscard]] virtual const NodeOpacity* measured(std::uint32_t node) const = 0;
};

struct PrefilterTask {
  const ObjectArrays& object;
  const WideTree& tree;
  std::span<const std::uint32_t> node_of;  ///< of the tree's nodes, the object's; empty: the same
  RefitRecord* record = nullptr;           ///< keeps what is found; may be none
  const Stumps* stumps = nullptr;
};

/// Sets all opacities below the tree's root, and returns the root's summary.
Summary prefilter(const PrefilterTask& task, const TextureIntegrals& integrals);

/// Child `slot`, whose exact box holds surfaces of these areas and normals by now, gets the opacity
/// that it keeps while it moves.
void set_kept_opacity(BvhNode& node, unsigned slot, const KeptOpacity& kept,
                      const SurfaceAreas& areas, const NormalMoments& normals, const Box3f& exact);

}  // namespace dapple
