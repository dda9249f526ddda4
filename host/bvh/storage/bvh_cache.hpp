// Finished trees in a folder, one sealed file an object, named by object_key(). What cannot be
// read back as it was written counts as not there.
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
};

/// What a file of the cache holds.
struct CachedObject {
  FinishedObject object;
  double build_seconds = 0;  ///< that building and prefiltering took
};

/// An object of `scene` whose arrays are the file's, mapped into memory. Nothing when there is no
/// file, or only one that is damaged or of another version, which `note` then says.
std::optional<CachedObject> read_cached_object(const std::string& folder, const Checksum& key,
                                               const Scene& scene, std::string& note);

/// Replaces whatever is there. Throws Error failed.
void write_cached_object(const std::string& folder, const Checksum& key,
                         const CachedObject& cached);

}  // namespace dapple
