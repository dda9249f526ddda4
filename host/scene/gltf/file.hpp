// Reads files for the glTF reader. In: a path; out: the bytes. Only regular files are read: a
// folder or a FIFO is an error, because reading a FIFO might block forever.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace dapple::gltf {

using Bytes = std::vector<std::uint8_t>;

/// The size limit of a file: lengths in GLB have 32 bits.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32;

/// Returns up to `max_bytes` bytes from the start of a regular file. Throws Error input when the
/// file does not exist, is not regular, cannot be read or is larger than kMaxFileBytes; the message
/// begins with `what`.
Bytes read_file(const std::filesystem::path& path, const std::string& what,
                std::uint64_t max_bytes = kMaxFileBytes);

}  // namespace dapple::gltf
