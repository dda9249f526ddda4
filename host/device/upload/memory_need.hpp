// Whether a device has the memory, asked before the minutes that building a large scene takes and
// again when its sizes are known.
#pragma once

#include <cstddef>

#include "dapple/device.hpp"

namespace dapple {

/// Bytes on the device.
struct MemoryNeed {
  std::size_t total = 0;
  std::size_t largest_buffer = 0;
};

/// The least that a scene can take, whatever is built of it: its triangles in blocks without a gap,
/// its textures and instances. A tenth to a half more is usual.
MemoryNeed min_need(const Scene& scene);

/// Throws Error device with needed and available bytes; `how` is "needs" or "needs at least".
void check_memory(const DeviceInfo& device, const MemoryNeed& need, const char* how);

}  // namespace dapple
