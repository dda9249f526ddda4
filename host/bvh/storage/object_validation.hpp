// Validates an object that was read from a file, so that no ray leaves its arrays or the traversal
// stack, whatever the file holds. (A checksum only shows accidental damage.)
#pragma once

#include "bvh/storage/bvh_cache.hpp"

namespace dapple {

/// Every index is inside its array, children come after their parents, and the object's stack is
/// what a traversal needs. Linear, in parallel where most of the bytes are.
bool is_sound(const FinishedObject& object, const Scene& scene);

}  // namespace dapple
