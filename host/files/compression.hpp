// Sections of our files made smaller by zstd, on all processors, at its fastest: a checkpoint is
// written while a picture waits, and disks are slower than that.
#pragma once

#include <cstddef>
#include <vector>

#include "files/sealed_file.hpp"

namespace dapple {

/// zstd frames, one after the other.
std::vector<std::byte> compress(Section bytes);

/// How many bytes `frames` become; none for what are not whole frames that tell.
std::size_t decompressed_size(Section frames);

/// Whether `frames` became `bytes`, filling them exactly.
bool decompress(Section frames, std::span<std::byte> bytes);

}  // namespace dapple
