// The BVH of one mesh, over triangles or over segments of strands, and the steps that make it:
// build, pack, prefilter.
#pragma once

#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "bvh/opacity/opaque_texels.hpp"
#include "bvh/opacity/texture_integrals.hpp"
#include "bvh/storage/large_pages.hpp"
#include "dapple/shared/geometry.h"

namespace dapple {

struct RefitRecord;  // bvh/refit/refit_record.hpp

/// The summary of an object for the top level and statistics.
struct ObjectSummary {
  Box3f box;
  std::vector<Box3f> parts;  ///< boxes of the root's children
  NodeOpacity opacity;       ///< of `box`
  std::uint32_t stack = 0;   ///< traversal stack entries needed
  double sah_cost = 0;       ///< expected node visits of a ray through `box`
  bool has_strands = false;
  /// Triangles, or segments, that are not fully transparent; of these by kind.
  std::size_t primitive_count = 0, opaque = 0, cut_out = 0, translucent = 0;
};

/// The BVH of an object. Its indices (child_base, prim_base, codes of textured triangles) count
/// from the first node, block and textured triangle of this object. Either `blocks` or `segments`
/// is empty.
struct ObjectBvh : ObjectSummary {
  LargeVector<BvhNode> nodes;
  LargeVector<TriangleBlock> blocks;
  LargeVector<SegmentBlock> segments;
  LargeVector<TexturedTriangle> textured;
  std::vector<std::uint32_t> primitives;  ///< by lane of the blocks: index in the mesh
};

/// A built object, and the data that prefiltering needs.
struct BuiltObject {
  ObjectBvh object;
  WideTree tree;                     ///< the tree from which the object was packed
  std::vector<std::uint8_t> closed;  ///< by block: bit l for lane l, closed_triangles(); or empty
  std::vector<float> interior;       ///< by lane: interior_triangles(); or empty
};

/// Builds and packs the triangles or segments of `mesh` that are not fully transparent. If there
/// are none, the object has no nodes. `texels`: of the scene.
BuiltObject build_object(const Scene& scene, const OpaqueTexels& texels, const Mesh& mesh);

/// Computes the opacities of the nodes and `opacity` of a packed object: bottom-up, in parallel and
/// in time linear in the number of triangles. Fills the `record` for refitting unless it is
/// nullptr.
void prefilter(BuiltObject& built, const TextureIntegrals& integrals,
               RefitRecord* record = nullptr);

/// Packs the boxes and the layout of a wide tree into nodes. The opacities stay 0. Leaf ends
/// count from 0; the caller sets `prim_base`, and adds its first lane to them.
LargeVector<BvhNode> pack_nodes(const WideTree& tree);

/// Returns the opacity of a node from its coverage map, its normals and its box.
NodeOpacity map_opacity(const CoverageMap& map, const NormalMoments& normals, const Box3f& box);

/// Stores a triangle of the mesh in a lane. `opacity`: in [0,1], or the code of a textured
/// triangle.
void set_lane(TriangleBlock& block, unsigned lane, const Mesh& mesh, std::uint32_t triangle,
              float opacity);

/// Returns a corner of the triangle in a lane.
inline V3f corner_of(const TriangleBlock& block, unsigned corner, unsigned lane) {
  const auto& v = block.vertex[corner];
  return {v[0][lane], v[1][lane], v[2][lane]};
}

/// Returns the edge from corner 0 to `corner`, 1 or 2.
inline V3f edge_of(const TriangleBlock& block, unsigned corner, unsigned lane) {
  return corner_of(block, corner, lane) - corner_of(block, 0, lane);
}

Box3f triangle_box(const Mesh& mesh, std::size_t triangle);

/// Returns the expected node visits of a random ray through the root's box. `half_areas`: sum of
/// half_area() over all nodes.
double expected_visits(double half_areas, const Box3f& root);

}  // namespace dapple
