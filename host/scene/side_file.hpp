// Files that a scene is given beside its own: lights, images of domes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dapple {

/// The whole regular file. `kind` is what errors call it, as in "lights file". Throws Error input
/// when there is none, for anything but a regular file, and past `most_bytes`.
std::vector<std::uint8_t> read_side_file(const std::string& path, const char* kind,
                                         std::uintmax_t most_bytes);

}  // namespace dapple
