// Compresses sections of files with zstd, on all processors, at a fast level: rendering stops while
// a checkpoint is written, and writing to disks is slower than this compression. In: bytes. Out:
// zstd frames, or the bytes again.
#pragma once

#include <cstddef>
#include <vector>

#include "files/sealed_file.hpp"

namespace dapple {

/// fastest: a third of the time for 1.7 times the size (experiment 820).
enum class CompressionLevel { standard, fastest };

/// Compresses `bytes` to zstd frames, one after the other. Throws Error failed.
std::vector<std::byte> compress(Section bytes, CompressionLevel level = CompressionLevel::standard);

/// Number of bytes that `frames` decompress to; 0 unless they are whole frames that state their
/// size.
std::size_t decompressed_size(Section frames);

/// Decompresses `frames` into `bytes`. False when they are damaged or do not fill `bytes` exactly.
bool decompress(Section frames, std::span<std::byte> bytes);

}  // namespace dapple
