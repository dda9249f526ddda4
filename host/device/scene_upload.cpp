#include "device/scene_upload.hpp"

#include <algorithm>
#include <cmath>

#include "device/light_upload.hpp"
#include "device/memory_need.hpp"

namespace dapple {
namespace {

void pack_textures(const Scene& scene, DeviceBuffers& buffers) {
  for (const Texture& texture : scene.textures) {
    buffers.texel_data.resize((buffers.texel_data.size() + 15) / 16 * 16);
    TextureRecord record{};
    record.offset = static_cast<uint>(buffers.texel_data.size() / 16);
    record.width = texture.width;
    record.height = texture.height;
    record.flags = static_cast<uint>(texture.wrap_s) | static_cast<uint>(texture.wrap_t) << 2 |
                   (texture.nearest ? 16u : 0u);
    buffers.texture_records.push_back(record);
    buffers.texel_data.insert(buffers.texel_data.end(), texture.alpha.begin(), texture.alpha.end());
  }
}

template <class T>
Buffer share(DeviceContext& context, const std::vector<T>& data) {
  return context.share(data.data(), data.size() * sizeof(T));
}

}  // namespace

DeviceScene upload(const Device& device, const Scene& scene, const SceneBvh& bvh) {
  auto buffers = std::make_shared<DeviceBuffers>(device);
  pack_textures(scene, *buffers);
  pack_lights(scene, buffers->light_records, buffers->emitter_triangles);
  DeviceContext& context = device.context();
  const auto bytes = [](const auto& data) { return data.size() * sizeof(data[0]); };
  DeviceScene result;
  result.bytes = bytes(bvh.nodes) + bytes(bvh.blocks) + bytes(bvh.textured) + bytes(bvh.instances) +
                 bytes(buffers->texture_records) + bytes(buffers->texel_data) +
                 bytes(buffers->light_records) + bytes(buffers->emitter_triangles);
  check_memory(device.info(), {result.bytes, std::max(bytes(bvh.nodes), bytes(bvh.blocks))},
               "needs");
  buffers->nodes = share(context, bvh.nodes);
  buffers->blocks = share(context, bvh.blocks);
  buffers->textured = share(context, bvh.textured);
  buffers->instances = share(context, bvh.instances);
  buffers->textures = share(context, buffers->texture_records);
  buffers->texels = share(context, buffers->texel_data);
  buffers->lights = share(context, buffers->light_records);
  buffers->emitters = share(context, buffers->emitter_triangles);
  buffers->params = {bvh.root, bvh.has_top ? 1u : 0u};
  context.finish();
  result.buffers = std::move(buffers);
  return result;
}

}  // namespace dapple
