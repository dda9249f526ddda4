// Whether the parts of a PNG or JPEG file are all there, before it is decoded: the decoder
// shows what is left of a cut or damaged file as if it were whole.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dapple {

/// What an image file is, by its first bytes.
enum class ImageFormat : std::uint8_t { png, jpeg, other };

ImageFormat image_format(std::span<const std::uint8_t> bytes);

/// Why a PNG file is not whole: its chunks must follow each other from IHDR to IEND with the
/// checksums that they carry. Empty when it is.
std::string png_defect(std::span<const std::uint8_t> bytes);

/// Why a JPEG file is not whole or takes too long to decode: its segments must follow each
/// other to an end of image, with no more scans than any encoder writes. Empty when it is.
std::string jpeg_defect(std::span<const std::uint8_t> bytes);

}  // namespace dapple
