// Bytes from disk for the glTF reader: whole regular files, and nothing else, since a
// folder or a FIFO given as a scene must be refused and not waited for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace dapple::gltf {

using Bytes = std::vector<std::uint8_t>;

/// The largest file read: GLB's own lengths have 32 bits.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32;

/// Up to `max_bytes` from the start of a regular file. Throws Error input, the message
/// beginning with `what`, when there is no such file, it is not regular, or it is
/// larger than kMaxFileBytes.
Bytes read_file(const std::filesystem::path& path, const std::string& what,
                std::uint64_t max_bytes = kMaxFileBytes);

}  // namespace dapple::gltf
