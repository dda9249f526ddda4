// Reads a file into memory: a lights file, the image of a dome light, a HAIR file.
// In: a path and a size limit; out: the file's bytes, or the first of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dapple {

/// Returns the bytes of a regular file. `kind` is the name of the file in errors, as in "lights
/// file". Throws Error input when the file does not exist, is not a regular file, cannot be read,
/// or has more than `max_bytes` bytes.
std::vector<std::uint8_t> read_side_file(const std::string& path, const char* kind,
                                         std::uintmax_t max_bytes);

/// The first 16 bytes, or all of a shorter file, under the same conditions.
std::vector<std::uint8_t> read_side_file_start(const std::string& path, const char* kind,
                                               std::uintmax_t max_bytes);

}  // namespace dapple
