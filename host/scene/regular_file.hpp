// Reads files into memory: glTF and its buffers, lights, images, hair, points. In: a path; out: the
// bytes. Only regular files are read: reading a FIFO might block forever.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace dapple {

using Bytes = std::vector<std::uint8_t>;

/// What messages call a file, as in "no such lights file", and how long it may be. Lengths in GLB
/// have 32 bits.
struct FileKind {
  const char* name = "file";
  std::uint64_t max_bytes = std::uint64_t{1} << 32;
};

/// Returns the bytes of a regular file, or the first `count` of a longer one. Throws Error input
/// when the file does not exist, is not regular, cannot be read or has more than kind.max_bytes;
/// the message begins with `what`.
Bytes read_regular_file(const std::filesystem::path& path, const std::string& what,
                        const FileKind& kind = {},
                        std::uint64_t count = std::numeric_limits<std::uint64_t>::max());

}  // namespace dapple
