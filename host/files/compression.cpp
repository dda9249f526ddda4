#include "files/compression.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <zstd.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "dapple/error.hpp"

namespace dapple {
namespace {

/// Bytes compressed into one frame: few enough that all processors get frames, and enough that the
/// number of frames hardly affects the compressed size.
constexpr std::size_t kFrame = std::size_t{1} << 20;
constexpr int kLevel = 1, kFastestLevel = -20;

/// A frame never decompresses to more than this times its size: zstd stores a block of 128 KiB
/// zeros in 4 bytes.
constexpr std::size_t kMaxGrowth = std::size_t{1} << 16;

/// One thread's context and output memory, reused for every frame: allocating memory for each takes
/// longer than compressing it.
struct FrameCompressor {
  /// For frames of at most `most_bytes` before compression.
  explicit FrameCompressor(std::size_t most_bytes) : capacity(ZSTD_compressBound(most_bytes)) {}

  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::size_t capacity;
  std::unique_ptr<std::byte[]> frame = std::make_unique_for_overwrite<std::byte[]>(capacity);
};

std::vector<std::byte> compress_frame(FrameCompressor& compressor, Section bytes,
                                      CompressionLevel level) {
  std::byte* frame = compressor.frame.get();
  const std::size_t size =
      ZSTD_compressCCtx(compressor.context.get(), frame, compressor.capacity, bytes.data(),
                        bytes.size(), level == CompressionLevel::fastest ? kFastestLevel : kLevel);
  if (ZSTD_isError(size)) {
    throw Error(ErrorKind::failed, std::string("cannot compress: ") + ZSTD_getErrorName(size));
  }
  return {frame, frame + size};
}

}  // namespace

std::vector<std::byte> compress(Section bytes, CompressionLevel level) {
  std::vector<std::vector<std::byte>> frames((bytes.size() + kFrame - 1) / kFrame);
  tbb::enumerable_thread_specific<FrameCompressor> compressors(std::min(kFrame, bytes.size()));
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    const std::size_t first = i * kFrame;
    frames[i] = compress_frame(compressors.local(),
                               bytes.subspan(first, std::min(kFrame, bytes.size() - first)), level);
  });
  std::vector<std::byte> all;
  all.reserve(
      std::accumulate(frames.begin(), frames.end(), std::size_t{0},
                      [](std::size_t sum, const auto& frame) { return sum + frame.size(); }));
  for (const std::vector<std::byte>& frame : frames)
    all.insert(all.end(), frame.begin(), frame.end());
  return all;
}

std::size_t decompressed_size(Section frames) {
  std::size_t all = 0;
  while (!frames.empty()) {
    const std::size_t size = ZSTD_findFrameCompressedSize(frames.data(), frames.size());
    const unsigned long long becomes = ZSTD_getFrameContentSize(frames.data(), frames.size());
    if (ZSTD_isError(size) || size > frames.size() || becomes > size * kMaxGrowth) return 0;
    all += becomes;
    frames = frames.subspan(size);
  }
  return all;
}

bool decompress(Section frames, std::span<std::byte> bytes) {
  if (frames.empty()) return bytes.empty();
  return ZSTD_decompress(bytes.data(), bytes.size(), frames.data(), frames.size()) == bytes.size();
}

}  // namespace dapple
