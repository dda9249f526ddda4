// The size of a slice: as much as suits the device, but a small picture has several.
#include "render/slice_params.hpp"

#include <gtest/gtest.h>

#include "render/trace_state.hpp"

namespace dapple {
namespace {

DeviceInfo device_of(const char* kind, unsigned units, std::size_t memory) {
  DeviceInfo info;
  info.kind = kind;
  info.compute_units = units;
  info.memory_bytes = memory;
  return info;
}

std::uint32_t samples(const DeviceInfo& device, std::size_t pixels, int spp) {
  RenderOptions options;
  options.light = false;
  options.spp = spp;
  return samples_of_slice(device, options, 0, 1, pixels);
}

constexpr std::size_t kHd = std::size_t{1920} * 1080;

TEST(SliceParams, GpusHaveLargeSlicesAndSmallPicturesSeveral) {
  const DeviceInfo cpu = device_of("CPU", 2, std::size_t{8} << 30);
  const DeviceInfo gpu = device_of("GPU", 132, std::size_t{80} << 30);
  const std::uint32_t on_cpu = samples(cpu, kHd, 64);
  EXPECT_EQ(samples(cpu, 100, 1), on_cpu);
  EXPECT_GE(samples(gpu, kHd, 64), 32 * on_cpu);
  EXPECT_LE(samples(gpu, kHd, 64), kHd * 64 / 8);
  EXPECT_EQ(samples(gpu, 48 * 30, 16), on_cpu);
}

TEST(SliceParams, SlicesLeaveMemoryForTheScene) {
  const DeviceInfo small = device_of("GPU", 132, std::size_t{2} << 30);
  // Queues of a sample and an AO ray: some 170 bytes.
  EXPECT_LE(std::size_t{170} * samples(small, kHd, 64), small.memory_bytes / 8);
  const DeviceInfo huge = device_of("GPU", 100'000, std::size_t{1} << 42);
  EXPECT_EQ(samples(huge, 1u << 24, 1 << 10), kMaxSliceSamples);
}

}  // namespace
}  // namespace dapple
