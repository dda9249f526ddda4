// Whether kernels may walk an object that came out of a file. A checksum shows damage; this shows
// so that no ray of any file, damaged or not, leaves the object's arrays or the traversal stack.
#pragma once

#include "bvh/storage/bvh_cache.hpp"

namespace dapple {

/// Every index is inside its array, children come after their parents, and the object's stack is
/// what a traversal needs. Linear, in parallel where most of the bytes are.
bool is_sound(const FinishedObject& object, const Scene& scene);

}  // namespace dapple
