// Reads of large buffers through pinned memory, which devices with memory of their own use.
#include "device/staged_read.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "device/platforms.hpp"

namespace dapple {
namespace {

TEST(StagedRead, CopiesEveryByteOfBuffersOfAnySize) {
  const cl::Device device = choose_device("");
  const cl::Context context(device);
  const cl::CommandQueue queue(context, device);
  StagedRead read(context, queue);
  constexpr std::size_t kPiece = std::size_t{16} << 20;
  for (const std::size_t bytes :
       {std::size_t{1}, kPiece - 1, kPiece, kPiece + 1, 2 * kPiece + 3, 3 * kPiece + 12'345}) {
    std::vector<std::uint8_t> values(bytes);
    std::uint32_t bits = 1;
    for (std::uint8_t& value : values) {
      bits = bits * 1664525u + 1013904223u;
      value = static_cast<std::uint8_t>(bits >> 24);
    }
    const cl::Buffer buffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, bytes,
                            values.data());
    std::vector<std::uint8_t> found(bytes + 1, 7);
    read.read(buffer, found.data(), bytes);
    EXPECT_EQ(std::memcmp(found.data(), values.data(), bytes), 0) << bytes;
    EXPECT_EQ(found[bytes], 7) << bytes;
  }
}

}  // namespace
}  // namespace dapple
