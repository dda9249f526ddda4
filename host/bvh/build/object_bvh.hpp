// One mesh's BVH, of triangles or of segments of strands, and the steps that make it: build, pack,
// prefilter.
#pragma once

#include <vector>

#include "bvh/build/wide_tree.hpp"
#include "bvh/opacity/coverage_map.hpp"
#include "bvh/opacity/node_opacity.hpp"
#include "bvh/opacity/triangle_opacity.hpp"
#include "dapple/shared/geometry.h"

namespace dapple {

struct RefitRecord;  // bvh/refit_record.hpp

/// The summary of an object for the top level and statistics.
struct ObjectSummary {
  Box3f box;
  std::vector<Box3f> parts;  ///< boxes of the root's children
  NodeOpacity opacity;       ///< of `box`
  std::uint32_t stack = 0;   ///< traversal stack entries needed
  double sah_cost = 0;       ///< expected node visits of a ray through `box`
  bool has_strands = false;
  /// Triangles, or segments, that are not fully transparent.
  std::size_t triangles = 0, opaque = 0, cut_out = 0, translucent = 0;
};

/// Indices inside (child_base, prim_base, textured codes) count from this object's own
/// first node, block and textured triangle. Either `blocks` or `segments` is empty.
struct ObjectBvh : ObjectSummary {
  std::vector<BvhNode> nodes;
  std::vector<TriangleBlock> blocks;
  std::vector<SegmentBlock> segments;
  std::vector<TexturedTriangle> textured;
};

/// A built object, and the data that prefiltering needs.
struct BuiltObject {
  ObjectBvh object;
  WideTree tree;                     ///< the object was packed from
  std::vector<std::uint8_t> closed;  ///< by block: bit l for lane l, closed_triangles(); or empty
  std::vector<std::uint32_t> triangles;  ///< by lane of the blocks: index in the mesh; or empty
};

/// Builds and packs the triangles or segments of `mesh` that are not fully transparent. Empty (no
/// nodes) when there are none. `keep_triangles`: fill BuiltObject::triangles.
BuiltObject build_object(const Scene& scene, const Mesh& mesh, bool keep_triangles = false);

/// Fills the nodes' opacities and `opacity` of a packed object, bottom-up, in parallel and in
/// time linear in the triangles; and the `record` for refitting, if any, for which
/// BuiltObject::triangles must be there.
void prefilter(BuiltObject& built, const TextureIntegrals& integrals,
               RefitRecord* record = nullptr);

/// Packs a wide tree's boxes and layout into nodes; opacities stay 0, `prim_base` is set
/// by the caller.
std::vector<BvhNode> pack_nodes(const WideTree& tree);

/// The coverage map and normals of a node, with its box.
NodeOpacity map_opacity(const CoverageMap& map, const NormalMoments& normals, const Box3f& box);

/// Stores the opacity of child `slot`, whose exact box had `opacity`, as that of its grown box.
/// Returns its clumping_factor().
float set_child_opacity(BvhNode& node, unsigned slot, const NodeOpacity& opacity,
                        const Box3f& exact);

/// variance_class() as stored with it.
unsigned variance_of_child(const BvhNode& node, unsigned slot);

/// Stores a triangle of the mesh in a lane. `opacity`: in [0,1], or the code of a textured
/// triangle.
void set_lane(TriangleBlock& block, unsigned lane, const Mesh& mesh, std::uint32_t triangle,
              float opacity);

Box3f triangle_box(const Mesh& mesh, std::size_t triangle);

/// Expected node visits of a random ray through the root's box, by the nodes' half_area() summed.
double expected_visits(double half_areas, const Box3f& root);

}  // namespace dapple
