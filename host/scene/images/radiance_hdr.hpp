// Decoding Radiance HDR images (.hdr, RGBE) from memory. Beside image.cpp the only file that knows
// stb_image.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "dapple/scene.hpp"

namespace dapple {

/// Whether the first bytes are those of such an image.
bool is_radiance_hdr(std::span<const std::uint8_t> bytes);

/// Throws Error input, the message beginning with `what`.
Environment decode_radiance_hdr(std::span<const std::uint8_t> bytes, const std::string& what);

}  // namespace dapple
