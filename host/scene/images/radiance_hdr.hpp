// Decodes Radiance HDR images (.hdr, RGBE) from memory. In: the bytes of a file; out: an
// Environment of linear RGB radiance. Only image.cpp and radiance_hdr.cpp use stb_image.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// Whether the first bytes are those of a Radiance HDR image.
bool is_radiance_hdr(std::span<const std::uint8_t> bytes);

/// Throws Error input; the message begins with `what`.
Environment decode_radiance_hdr(std::span<const std::uint8_t> bytes, const std::string& what);

}  // namespace dapple
