#include "device/scene_upload.hpp"

#include <algorithm>
#include <cmath>

#include "bvh/triangle_opacity.hpp"
#include "device/dome_upload.hpp"
#include "device/light_upload.hpp"
#include "device/memory_need.hpp"

namespace dapple {
namespace {

/// Appends the texture's texels, once for all materials that it is of.
TextureRecord pack_texture(const Texture& texture, std::vector<uchar>& texels) {
  texels.resize((texels.size() + 15) / 16 * 16);
  TextureRecord record{};
  record.offset = static_cast<uint>(texels.size() / 16);
  record.width = texture.width;
  record.height = texture.height;
  record.flags = static_cast<uint>(texture.wrap_s) | static_cast<uint>(texture.wrap_t) << 2 |
                 (texture.nearest ? 16u : 0u);
  texels.insert(texels.end(), texture.alpha.begin(), texture.alpha.end());
  return record;
}

/// One record a material, in their order, as textured triangles name them.
void pack_materials(const Scene& scene, DeviceBuffers& buffers) {
  std::vector<TextureRecord> textures;
  for (const Texture& texture : scene.textures)
    textures.push_back(pack_texture(texture, buffers.texel_data));
  for (const Material& material : scene.materials) {
    MaterialRecord record{};
    if (material.alpha_texture >= 0) record.texture = textures[material.alpha_texture];
    record.alpha = material.alpha;
    record.cutoff = cutoff_of(material);
    buffers.material_records.push_back(record);
  }
}

template <class Array>
Buffer share(DeviceContext& context, const Array& data) {
  return context.share(data.data(), data.size() * sizeof(data[0]));
}

}  // namespace

DeviceScene upload(const Device& device, const Scene& scene, const SceneBvh& bvh) {
  auto buffers = std::make_shared<DeviceBuffers>(device);
  if (!bvh.textured.empty()) pack_materials(scene, *buffers);
  pack_lights(scene, buffers->light_records, buffers->emitter_triangles);
  pack_domes(scene, buffers->light_records, buffers->environment_data);
  DeviceContext& context = device.context();
  const auto bytes = [](const auto& data) { return data.size() * sizeof(data[0]); };
  DeviceScene result;
  result.bytes = bytes(bvh.nodes) + bytes(bvh.blocks) + bytes(bvh.segments) + bytes(bvh.textured) +
                 bytes(bvh.instances) + bytes(buffers->material_records) +
                 bytes(buffers->texel_data) + bytes(buffers->light_records) +
                 bytes(buffers->emitter_triangles) + bytes(buffers->environment_data);
  check_memory(device.info(),
               {result.bytes, std::max({bytes(bvh.nodes), bytes(bvh.blocks), bytes(bvh.segments)})},
               "needs");
  buffers->nodes = share(context, bvh.nodes);
  buffers->blocks = share(context, bvh.blocks);
  buffers->segments = share(context, bvh.segments);
  buffers->textured = share(context, bvh.textured);
  buffers->instances = share(context, bvh.instances);
  buffers->materials = share(context, buffers->material_records);
  buffers->texels = share(context, buffers->texel_data);
  buffers->lights = share(context, buffers->light_records);
  buffers->emitters = share(context, buffers->emitter_triangles);
  buffers->environments = share(context, buffers->environment_data);
  buffers->params = {bvh.root, bvh.has_top ? 1u : 0u};
  context.finish();
  result.buffers = std::move(buffers);
  return result;
}

}  // namespace dapple
