// Compares the memory that a picture needs while it is rendered with the memory of the machine and
// of the device. Without this check the operating system would end the process when a picture is
// too large. In: a view and its lights. Out: an Error.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "camera/view.hpp"
#include "dapple/device.hpp"

namespace dapple {

/// Throws Error usage when the sums and layers of a picture of this many lights take more than
/// half of the machine's memory. `options`: its further layers.
void check_film_memory(const View& view, std::size_t light_count,
                       const RenderOptions& options = {});

/// Throws Error device when the sums of such a picture are larger than the device's largest buffer.
/// `is_smooth`: whether the scene has shading normals; called only if that decides.
void check_film_buffer(const DeviceInfo& device, const View& view, const std::vector<Light>& lights,
                       const RenderOptions& options, const std::function<bool()>& is_smooth);

/// Bytes that each pixel of such a picture takes while it is rendered.
std::size_t film_bytes_per_pixel(std::size_t light_count, const RenderOptions& options);

}  // namespace dapple
