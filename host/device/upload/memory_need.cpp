#include "device/upload/memory_need.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bvh/opacity/opacity_mip_levels.hpp"
#include "dapple/error.hpp"

namespace dapple {

MemoryNeed min_need(const Scene& scene) {
  std::size_t triangles = 0, segments = 0, texels = 0;
  for (const Mesh& mesh : scene.meshes)
    (mesh.has_strands() ? segments : triangles) += mesh.primitive_count();
  for (const Texture& texture : scene.textures)
    texels += mip_level_texels(texture.width, texture.height);
  MemoryNeed need;
  const std::size_t blocks = (triangles + 7) / 8 * sizeof(TriangleBlock);
  const std::size_t segment_blocks = (segments + 7) / 8 * sizeof(SegmentBlock);
  need.largest_buffer = std::max(blocks, segment_blocks);
  need.total = blocks + segment_blocks + texels + scene.instances.size() * sizeof(InstanceRecord);
  return need;
}

void check_memory(const DeviceInfo& device, const MemoryNeed& need, const char* how) {
  constexpr const char* kNext = "take fewer triangles, more instances, or another --device";
  if (need.total > device.memory_bytes) {
    throw Error(ErrorKind::device,
                fmt::format("the scene {} {} bytes of device memory, {} has {}; {}", how,
                            need.total, device.name, device.memory_bytes, kNext));
  }
  if (need.largest_buffer > device.largest_buffer_bytes) {
    throw Error(ErrorKind::device,
                fmt::format("the scene {} {} bytes in one buffer, {} gives {} at most; {}", how,
                            need.largest_buffer, device.name, device.largest_buffer_bytes, kNext));
  }
}

}  // namespace dapple
