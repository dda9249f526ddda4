// Media types of image files. In: their bytes and names. Out: the types that glTF's core and
// extensions use.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace dapple {

/// "image/png", "image/jpeg", "image/webp", "image/ktx2", "image/vnd-ms.dds" or "image/avif": by
/// how the file begins, else by the suffix of `name`; else "image/png".
std::string image_media_type(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace dapple
