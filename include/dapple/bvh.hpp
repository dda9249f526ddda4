// The acceleration structure, finished on the host before any device exists: 8-wide BVHs
// over the meshes, one over their instances, opacity in every node.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"
#include "dapple/shared/geometry.h"

namespace dapple {

/// What building took and made; seconds are wall time.
struct BvhStatistics {
  double build_seconds = 0;                              ///< SAH build, collapse, quantization
  double prefilter_seconds = 0;                          ///< directional opacity
  std::size_t triangles = 0;                             ///< distinct, before instancing
  std::size_t opaque = 0, cut_out = 0, translucent = 0;  ///< of `triangles`
  std::size_t instanced_triangles = 0;
  std::size_t instances = 0;
  double lane_use = 0;  ///< used lanes of all triangle blocks, [0,1]
  double sah_cost = 0;  ///< expected node visits a ray through the largest object's root
  float root_opacity[3] = {0, 0, 0};  ///< of the whole scene's box, along x, y, z
};

struct SceneBvh {
  std::vector<BvhNode> nodes;  ///< all objects', then the top level's
  std::vector<TriangleBlock> blocks;
  std::vector<TexturedTriangle> textured;
  std::vector<InstanceRecord> instances;  ///< in the order of the top level's leaves
  std::uint32_t root = 0;                 ///< node to start from
  bool has_top = false;                   ///< false: `root` is the only object's, in world space
  Box3f bounds;                           ///< world space
  BvhStatistics statistics;
};

/// Builds everything for a scene with at least one triangle that can be hit. Linear in the
/// triangles, parallel, and the same bits whatever the thread count. Throws Error failed
/// when the tree is too deep for the kernels' stack or too large for 32-bit indices.
SceneBvh build_bvh(const Scene& scene);

}  // namespace dapple
