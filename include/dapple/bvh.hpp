// The acceleration structure: 8-wide BVHs over the meshes and one over their instances, with the
// opacity of every child. In: a Scene; out: arrays that upload() copies to a device. Nothing here
// needs a device.
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

/// Time and result of a build; seconds are wall time.
struct BvhStatistics {
  double build_seconds = 0;                              ///< SAH build, collapse, quantization
  double prefilter_seconds = 0;                          ///< directional opacity
  double instance_seconds = 0;                           ///< BVH over instances, with opacity
  std::size_t triangles = 0;                             ///< distinct, before instancing
  std::size_t segments = 0;                              ///< segments of strands, distinct too
  std::size_t opaque = 0, cut_out = 0, translucent = 0;  ///< of `triangles`
  std::size_t instanced_triangles = 0, instanced_segments = 0;
  std::size_t instances = 0;
  double lane_use = 0;  ///< used lanes of all blocks, [0,1]
  double sah_cost = 0;  ///< expected node visits a ray through the largest object's root
  float root_opacity[3] = {0, 0, 0};  ///< of the whole scene's box, along x, y, z
  /// The BVH cache. Small objects are always built and count in neither number.
  struct {
    std::size_t objects_read = 0, objects_written = 0;
    double read_seconds = 0, write_seconds = 0;
    double seconds_saved = 0;  ///< build time of the objects that were read, less read_seconds
    std::string note;          ///< one line about damaged files; empty: there were none
  } cache;
};

/// A lane of a block that holds no triangle or segment.
inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;

/// Number of elements that precede an object in each array of the scene. An object has blocks of
/// triangles or of segments, not both.
struct ObjectOffsets {
  std::uint32_t node = 0, block = 0, segments = 0, textured = 0;

  /// Index in SceneBvh::primitives.
  [[nodiscard]] std::size_t lane() const { return 8 * (std::size_t{block} + segments); }
};

struct SceneBvh {
  ConstArray<BvhNode> nodes;  ///< nodes of all objects, then of the top level
  ConstArray<TriangleBlock> blocks;
  ConstArray<SegmentBlock> segments;
  ConstArray<TexturedTriangle> textured;
  ConstArray<InstanceRecord> instances;  ///< in the order of the top level's leaves
  ConstArray<std::uint32_t> primitives;  ///< of each lane: index in its mesh, or kNoPrimitive
  std::vector<ObjectOffsets> objects;    ///< of each mesh, and one more with the totals
  std::uint32_t root = 0;                ///< node to start from
  bool has_top = false;  ///< false: `root` belongs to the only object, in world space
  Box3f bounds;          ///< world space
  BvhStatistics statistics;
};

/// Makes a folder for built BVHs if there is none, checks that files can be read and written there,
/// and removes unfinished files of earlier runs. Throws Error usage, which names --cache.
void prepare_bvh_cache(const std::string& folder);

/// Builds the BVH of a scene, which must have a triangle or segment that can be hit. The time grows
/// as n log n with n triangles, that of their opacities as n. Runs in parallel; the bits do not
/// depend on the number of threads. With a `cache_folder`, objects that were built before are read
/// from it, with the same bits, and others are written to it; damaged files and those of other
/// versions are replaced. Throws Error failed if the BVH is too deep for the kernels' stack or too
/// large for 32-bit indices.
SceneBvh build_bvh(const Scene& scene, const std::string& cache_folder = "");

/// A range of indices of an array: begin, up to but not including end.
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

/// The result of UpdatableBvh::update().
struct BvhUpdate {
  std::size_t objects_kept = 0;      ///< did not move
  std::size_t objects_refitted = 0;  ///< kept their BVH, with new boxes
  std::size_t objects_rebuilt = 0;   ///< changed in more than positions, or became too costly
  double seconds = 0;                ///< wall time
  double cost_ratio = 1;  ///< largest traversal cost (SAH) after refitting over that after building
  bool is_new = false;    ///< all arrays were replaced
  /// If not is_new: the ranges of nodes and triangle blocks that changed.
  std::vector<IndexRange> nodes, blocks;
  bool textured = false;   ///< if not is_new: whether records of textured triangles changed
  bool placement = false;  ///< if not is_new: whether instances, root and bounds changed
};

/// A SceneBvh that is updated when its scene moves.
class UpdatableBvh {
 public:
  enum class Motion {
    maybe,     ///< objects are rebuilt when they first move; needs no memory before that
    expected,  ///< keeps what refitting needs from the start, about 20 bytes a triangle
  };

  /// Builds as build_bvh(); `cache_folder` is used only with Motion::maybe.
  explicit UpdatableBvh(const Scene& scene, Motion motion = Motion::expected,
                        const std::string& cache_folder = "");
  ~UpdatableBvh();
  UpdatableBvh(UpdatableBvh&&) noexcept;
  UpdatableBvh& operator=(UpdatableBvh&&) noexcept;

  /// Updates the BVH to `moved`. Objects whose vertices moved are refitted, in time linear in their
  /// triangles; the bits do not depend on the number of threads. Objects whose BVHs became too
  /// costly are rebuilt, as are meshes that changed in more than positions, and all meshes if their
  /// number changed. The top level is always rebuilt. Arrays change in place: no device may use
  /// them meanwhile. Throws as build_bvh().
  BvhUpdate update(const Scene& moved);

  [[nodiscard]] const SceneBvh& bvh() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dapple
