#include "device/staged_read.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

namespace dapple {
namespace {

constexpr std::size_t kPieces = 2;
constexpr std::size_t kPieceBytes = std::size_t{16} << 20;

/// Bytes that a thread copies at a time.
constexpr std::size_t kCopiedTogether = std::size_t{1} << 18;

void copy_in_parallel(void* to, const void* from, std::size_t bytes) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, bytes, kCopiedTogether),
                    [&](const tbb::blocked_range<std::size_t>& part) {
                      std::memcpy(static_cast<std::byte*>(to) + part.begin(),
                                  static_cast<const std::byte*>(from) + part.begin(), part.size());
                    });
}

}  // namespace

StagedRead::StagedRead(const cl::Context& context, const cl::CommandQueue& queue)
    : queue_(queue), pieces_(kPieces) {
  for (Piece& piece : pieces_) {
    piece.buffer = cl::Buffer(context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, kPieceBytes);
    piece.pinned =
        queue_.enqueueMapBuffer(piece.buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, kPieceBytes);
  }
}

StagedRead::~StagedRead() {
  for (const Piece& piece : pieces_) {
    if (piece.pinned)
      clEnqueueUnmapMemObject(queue_(), piece.buffer(), piece.pinned, 0, nullptr, nullptr);
  }
  clFinish(queue_());
}

void StagedRead::read(const cl::Buffer& buffer, void* to, std::size_t bytes) {
  const auto fill = [&](std::size_t begin) {
    Piece& piece = pieces_[begin / kPieceBytes % kPieces];
    queue_.enqueueReadBuffer(buffer, CL_FALSE, begin, std::min(kPieceBytes, bytes - begin),
                             piece.pinned, nullptr, &piece.filled);
    queue_.flush();
  };
  for (std::size_t begin = 0; begin < std::min(bytes, kPieces * kPieceBytes); begin += kPieceBytes)
    fill(begin);
  for (std::size_t begin = 0; begin < bytes; begin += kPieceBytes) {
    const Piece& piece = pieces_[begin / kPieceBytes % kPieces];
    piece.filled.wait();
    copy_in_parallel(static_cast<std::byte*>(to) + begin, piece.pinned,
                     std::min(kPieceBytes, bytes - begin));
    const std::size_t next = begin + kPieces * kPieceBytes;
    if (next < bytes) fill(next);
  }
}

}  // namespace dapple
