// Decoding PNG and JPEG images from memory: alpha channels for opacity, the mean colour
// for emission. The only file that knows stb_image.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dapple {

/// Images with more pixels than this are refused before they are decoded.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 28;

struct AlphaImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> alpha;  ///< width * height, top row first
};

/// The alpha channel; 255 everywhere for an image without one; 16-bit alpha keeps its
/// high byte. Throws Error input, the message beginning with `what`.
AlphaImage decode_alpha(std::span<const std::uint8_t> bytes, const std::string& what);

/// The mean over all pixels of the colour, from sRGB to linear, in [0,1]. Throws as
/// decode_alpha does.
Imath::V3f mean_linear_color(std::span<const std::uint8_t> bytes, const std::string& what);

}  // namespace dapple
