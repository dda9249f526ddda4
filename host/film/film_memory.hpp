// Compares the memory that a picture needs while it is rendered with the memory of the machine.
// Without this check the operating system would end the process when a picture is too large. In: a
// view and the number of lights. Out: an Error.
#pragma once

#include <cstddef>

#include "camera/view.hpp"

namespace dapple {

/// Throws Error usage when the sums and layers of a picture of this many lights take more than
/// half of the machine's memory. `options`: its further layers.
void check_film_memory(const View& view, std::size_t light_count,
                       const RenderOptions& options = {});

/// Bytes that each pixel of such a picture takes while it is rendered.
std::size_t film_bytes_per_pixel(std::size_t light_count, const RenderOptions& options);

}  // namespace dapple
