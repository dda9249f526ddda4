// Decodes PNG, JPEG and WebP images from memory. In: the bytes of a file; out: the alpha channel,
// for opacity, all channels, for albedo, or the mean colour, for emission. Only image.cpp and
// radiance_hdr.cpp use stb_image, only webp.cpp libwebp.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dapple {

/// An image with more pixels is an error, which is found before the image is decoded.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 28;

/// The number of pixels by the file's header; 0 if it cannot be told.
std::uint64_t pixel_count(std::span<const std::uint8_t> bytes);

struct AlphaImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> alpha;  ///< width * height, top row first
};

struct ColorImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgb;    ///< 3 * width * height
  std::vector<std::uint8_t> alpha;  ///< width * height
};

/// Returns all channels, as decode_alpha() does.
ColorImage decode_color(std::span<const std::uint8_t> bytes, const std::string& what);

/// Returns the alpha channel: 255 everywhere for an image without one, the high byte of a 16-bit
/// one. Throws Error input; the message begins with `what`.
AlphaImage decode_alpha(std::span<const std::uint8_t> bytes, const std::string& what);

/// Returns the mean over all pixels of the colour, converted from sRGB to linear, in [0,1].
/// Throws like decode_alpha().
Imath::V3f mean_linear_color(std::span<const std::uint8_t> bytes, const std::string& what);

}  // namespace dapple
