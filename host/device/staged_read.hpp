// Reads large buffers of devices that have memory of their own. In: a buffer. Out: its bytes in the
// host's memory.
#pragma once

#include <cstddef>
#include <vector>

#include "device/opencl.hpp"

namespace dapple {

/// Copies in parts through two pieces of pinned memory, in turn: the device writes one while
/// threads copy the other to its place. A GPU's driver copies to other memory with one thread.
class StagedRead {
 public:
  /// Throws cl::Error.
  StagedRead(const cl::Context& context, const cl::CommandQueue& queue);
  StagedRead(const StagedRead&) = delete;
  StagedRead& operator=(const StagedRead&) = delete;
  ~StagedRead();
  /// Waits until all is copied. Throws cl::Error.
  void read(const cl::Buffer& buffer, void* to, std::size_t bytes);

 private:
  struct Piece {
    cl::Buffer buffer;
    void* pinned = nullptr;
    cl::Event filled;
  };
  cl::CommandQueue queue_;
  std::vector<Piece> pieces_;
};

}  // namespace dapple
