// The BVH cache: a folder with one sealed file for each object, named by object_key(). A file that
// cannot be read back as it was written counts as missing: finish_objects() then builds the object
// again, replaces the file, and a note says so.
#pragma once

#include <optional>
#include <string>

#include "bvh/build/object_bvh.hpp"
#include "dapple/const_array.hpp"
#include "files/checksum.hpp"

namespace dapple {

/// An object that is packed and prefiltered.
struct FinishedObject : ObjectSummary {
  FinishedObject() = default;
  explicit FinishedObject(ObjectBvh&& object);
  ConstArray<BvhNode> nodes;
  ConstArray<TriangleBlock> blocks;
  ConstArray<SegmentBlock> segments;
  ConstArray<TexturedTriangle> textured;
  ConstArray<std::uint32_t> primitives;
};

/// The content of a cache file.
struct CachedObject {
  FinishedObject object;
  double build_seconds = 0;  ///< time to build and prefilter the object
};

/// Returns an object of `scene` whose arrays are mapped from the file. Returns nothing if there is
/// no file, or if it is damaged or of another version; `note` then says so.
std::optional<CachedObject> read_cached_object(const std::string& folder, const Checksum& key,
                                               const Scene& scene, std::string& note);

/// Writes the cache file of an object and replaces an existing one. Throws Error failed.
void write_cached_object(const std::string& folder, const Checksum& key,
                         const CachedObject& cached);

}  // namespace dapple
