// Validates an object that was read from a file, so that a traversal never leaves its arrays or
// overflows its stack, whatever the file contains. (A checksum detects only accidental damage.)
#pragma once

#include "bvh/storage/bvh_cache.hpp"

namespace dapple {

/// Whether every index is inside its array, children come after their parents, the object's `stack`
/// is what a traversal needs, and its boxes and opacity can be placed. Takes linear time; triangle
/// blocks are checked in parallel.
bool is_sound(const FinishedObject& object, const Scene& scene);

}  // namespace dapple
