// Checks whether a device has enough memory for a scene: by a lower bound before the BVH is built,
// and by the true sizes afterwards. In: a scene, a device. Out: bytes, or an Error.
#pragma once

#include <cstddef>

#include "dapple/device.hpp"

namespace dapple {

/// Bytes on the device.
struct MemoryNeed {
  std::size_t total = 0;
  std::size_t largest_buffer = 0;
};

/// The minimum that a scene needs, whatever the builder makes of it: its triangles and segments in
/// full blocks, its textures and its instances. A tenth to a half more is usual.
MemoryNeed min_need(const Scene& scene);

/// Throws Error device, with needed and available bytes, when `need` is too large for `device`.
/// `how` is "needs" or "needs at least".
void check_memory(const DeviceInfo& device, const MemoryNeed& need, const char* how);

}  // namespace dapple
