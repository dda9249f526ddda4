// Writes a GLB container (glTF 2.0 Specification, section 4). In: JSON text and the binary chunk.
// Out: a file, verified, that has not its name yet.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "files/output_file.hpp"

namespace dapple {

/// The binary chunk is the sections one after the other; its size must be a multiple of 4.
/// `others`: chunks of other types with their headers, which come last. Throws Error failed when
/// the file cannot be written or would be larger than GLB's 32-bit lengths.
void write_glb_bytes(PendingFile& file, std::string json, std::span<const std::string_view> binary,
                     std::string_view others = {});

}  // namespace dapple
