// Checks that a PNG or JPEG file is complete before it is decoded, because the decoder returns an
// image without an error for a cut or damaged file. In: the bytes of a file; out: the text of a
// message, empty for a complete file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dapple {

enum class ImageFormat : std::uint8_t { png, jpeg, webp, other };

/// Finds the format from the first bytes of a file.
ImageFormat image_format(std::span<const std::uint8_t> bytes);

/// Says why a PNG file is incomplete: chunks must follow each other from IHDR to IEND, and their
/// checksums must be right. Returns "" for a complete file.
std::string png_defect(std::span<const std::uint8_t> bytes);

/// Says why a JPEG file is incomplete or takes too long to decode: segments must follow each other
/// up to the end-of-image marker, and there may be at most 100 scans, more than encoders write.
/// Returns "" for a complete file.
std::string jpeg_defect(std::span<const std::uint8_t> bytes);

}  // namespace dapple
