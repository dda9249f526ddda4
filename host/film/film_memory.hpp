// What a picture takes while it is rendered, against what the machine has: without this a
// picture that is too large ends in the operating system's hands.
#pragma once

#include <cstddef>

#include "camera/view.hpp"

namespace dapple {

/// Throws Error usage when the sums and layers of a picture of this many lights take more than
/// half of the machine's memory.
void check_film_memory(const View& view, std::size_t light_count);

}  // namespace dapple
