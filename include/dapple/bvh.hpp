// The acceleration structure, finished on the host before any device exists: 8-wide BVHs
// over the meshes, one over their instances, opacity in every node.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dapple/const_array.hpp"
#include "dapple/scene.hpp"
#include "dapple/shared/bvh_node.h"
#include "dapple/shared/geometry.h"

namespace dapple {

/// What building took and made; seconds are wall time.
struct BvhStatistics {
  double build_seconds = 0;                              ///< SAH build, collapse, quantization
  double prefilter_seconds = 0;                          ///< directional opacity
  std::size_t triangles = 0;                             ///< distinct, before instancing
  std::size_t segments = 0;                              ///< of strands, likewise
  std::size_t opaque = 0, cut_out = 0, translucent = 0;  ///< of `triangles`
  std::size_t instanced_triangles = 0, instanced_segments = 0;
  std::size_t instances = 0;
  double lane_use = 0;  ///< used lanes of all blocks, [0,1]
  double sah_cost = 0;  ///< expected node visits a ray through the largest object's root
  float root_opacity[3] = {0, 0, 0};  ///< of the whole scene's box, along x, y, z
  /// Of the cache of trees. Small objects are built anew without it and count among neither.
  struct {
    std::size_t objects_read = 0, objects_written = 0;
    double read_seconds = 0, write_seconds = 0;
    double seconds_saved = 0;  ///< that building what was read once took, less read_seconds
    std::string note;          ///< what was wrong with its files, one line; empty: nothing
  } cache;
};

struct SceneBvh {
  ConstArray<BvhNode> nodes;  ///< all objects', then the top level's
  ConstArray<TriangleBlock> blocks;
  ConstArray<SegmentBlock> segments;
  ConstArray<TexturedTriangle> textured;
  ConstArray<InstanceRecord> instances;  ///< in the order of the top level's leaves
  std::uint32_t root = 0;                ///< node to start from
  bool has_top = false;                  ///< false: `root` is the only object's, in world space
  Box3f bounds;                          ///< world space
  BvhStatistics statistics;
};

/// Makes a folder for built trees if there is none, checks that files can be read and written
/// there, and removes what killed runs left in it. Throws Error usage, which names --cache.
void prepare_bvh_cache(const std::string& folder);

/// Builds everything for a scene with at least one triangle that can be hit. Linear in the
/// triangles, parallel, and the same bits whatever the thread count. With a `cache_folder` objects
/// that were built before are read from there, the same bits again, and others written there;
/// files that are damaged or of another version are replaced. Throws Error failed when the tree is
/// too deep for the kernels' stack or too large for 32-bit indices.
SceneBvh build_bvh(const Scene& scene, const std::string& cache_folder = "");

/// From one value of an array up to another.
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

/// What an update of an UpdatableBvh did.
struct BvhUpdate {
  std::size_t objects_kept = 0;      ///< they had not moved
  std::size_t objects_refitted = 0;  ///< over the trees that they had
  std::size_t objects_rebuilt = 0;   ///< for want of a record, by another form, or by cost_ratio
  double seconds = 0;                ///< wall time
  double cost_ratio = 1;  ///< SAH cost after refitting over that when built, of the worst object
  bool is_new = false;    ///< every array is another one
  /// Else these parts of the nodes and triangle blocks changed.
  std::vector<IndexRange> nodes, blocks;
  bool placement = false;  ///< and the instances, root and bounds
};

/// A SceneBvh that follows its scene as things move.
class UpdatableBvh {
 public:
  enum class Motion {
    maybe,     ///< objects are built anew when they first move; until then nothing more is kept
    expected,  ///< what refitting needs is kept from the start, some 20 bytes a triangle
  };

  /// Builds as build_bvh(); `cache_folder` is of use when motion is not expected.
  explicit UpdatableBvh(const Scene& scene, Motion motion = Motion::expected,
                        const std::string& cache_folder = "");
  ~UpdatableBvh();
  UpdatableBvh(UpdatableBvh&&) noexcept;
  UpdatableBvh& operator=(UpdatableBvh&&) noexcept;

  /// Makes it the BVH of `moved`. Objects whose vertices moved are refitted, in time linear in
  /// their triangles and with the same bits whatever the thread count, and rebuilt when their trees
  /// have become too costly; the top level is made anew. Meshes that are not what they were in more
  /// than positions are rebuilt, and all when there is another number of meshes. Arrays change in
  /// place: no device may be using them (HostAccess). Throws as build_bvh().
  BvhUpdate update(const Scene& moved);

  [[nodiscard]] const SceneBvh& bvh() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dapple
