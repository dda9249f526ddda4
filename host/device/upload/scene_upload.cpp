#include "device/upload/scene_upload.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <numeric>

#include "dapple/error.hpp"
#include "device/upload/dome_upload.hpp"
#include "device/upload/light_upload.hpp"
#include "device/upload/memory_need.hpp"
#include "device/upload/normal_upload.hpp"
#include "device/upload/texture_upload.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/lights/dark_light.hpp"

namespace dapple {
namespace {

template <class Array>
Buffer share(DeviceContext& context, const Array& data) {
  return context.share(data.data(), data.size() * sizeof(data[0]));
}

template <class Array>
std::size_t bytes_of(const Array& data) {
  return data.size() * sizeof(data[0]);
}

/// Of buffers with these bytes.
MemoryNeed need_of(std::initializer_list<std::size_t> buffers) {
  return {std::accumulate(buffers.begin(), buffers.end(), std::size_t{0}), std::max(buffers)};
}

std::size_t bytes_of_all(const DeviceBuffers& b) {
  return b.nodes.bytes() + b.blocks.bytes() + b.segments.bytes() + b.textured.bytes() +
         b.instances.bytes() + b.materials.bytes() + b.texels.bytes() + b.lights.bytes() +
         b.emitters.bytes() + b.environments.bytes() + b.normals.bytes() + b.color_words.bytes() +
         b.color_materials.bytes() + b.color_texels.bytes();
}

/// Replaces `values` by `now`, and shares them as `buffer`, unless both are the same already.
template <class T>
void share_if_new(DeviceContext& context, std::vector<T> now, std::vector<T>& values,
                  Buffer& buffer) {
  if (now.size() == values.size() &&
      (now.empty() || std::memcmp(now.data(), values.data(), bytes_of(now)) == 0))
    return;
  buffer = {};
  values = std::move(now);
  buffer = share(context, values);
}

std::vector<bool> dark_lights(const Scene& scene) {
  std::vector<bool> dark;
  for (const Light& light : scene.lights) dark.push_back(is_dark(light));
  return dark;
}

void share_lights(DeviceContext& context, const Scene& scene, DeviceBuffers& buffers) {
  std::vector<LightRecord> records;
  std::vector<EmitterTriangle> emitters;
  std::vector<float> environments;
  pack_lights(scene, records, emitters);
  pack_domes(scene, records, environments);
  buffers.dark_lights = dark_lights(scene);
  share_if_new(context, std::move(records), buffers.light_records, buffers.lights);
  share_if_new(context, std::move(emitters), buffers.emitter_triangles, buffers.emitters);
  share_if_new(context, std::move(environments), buffers.environment_data, buffers.environments);
}

void share_placement(DeviceContext& context, const SceneBvh& bvh, DeviceBuffers& buffers) {
  buffers.instances = {};
  buffers.instance_records = bvh.instances;
  buffers.instances = share(context, buffers.instance_records);
  buffers.params = {bvh.root, bvh.has_top ? 1u : 0u};
}

template <class Array>
void write_ranges(DeviceContext& context, const Buffer& buffer, const Array& data,
                  const std::vector<IndexRange>& ranges) {
  for (const IndexRange& range : ranges) {
    context.write(buffer, &data[range.begin], (range.end - range.begin) * sizeof(data[0]),
                  range.begin * sizeof(data[0]));
  }
}

}  // namespace

void check_uploaded(const DeviceScene& scene) {
  if (!scene.buffers) throw Error(ErrorKind::usage, "there is no scene on the device: upload one");
}

DeviceScene upload(const Device& device, const Scene& scene, const SceneBvh& bvh,
                   const UploadOptions& options) {
  check_scene(scene);
  auto buffers = std::make_shared<DeviceBuffers>(device);
  if (!bvh.textured.empty()) pack_materials(scene, buffers->material_records, buffers->texel_data);
  pack_lights(scene, buffers->light_records, buffers->emitter_triangles);
  pack_domes(scene, buffers->light_records, buffers->environment_data);
  buffers->dark_lights = dark_lights(scene);
  buffers->uploaded = options;
  if (options.normals) buffers->corner_normals = pack_normals(scene, bvh, options.flat_normals);
  if (options.colors) {
    buffers->colors = pack_colors(scene, bvh);
    buffers->color_key = color_key(scene);
  }
  DeviceContext& context = device.context();
  DeviceScene result;
  const SurfaceColors& colors = buffers->colors;
  const MemoryNeed need = need_of(
      {bytes_of(bvh.nodes), bytes_of(bvh.blocks), bytes_of(bvh.segments), bytes_of(bvh.textured),
       bytes_of(bvh.instances), bytes_of(buffers->material_records), bytes_of(buffers->texel_data),
       bytes_of(buffers->light_records), bytes_of(buffers->emitter_triangles),
       bytes_of(buffers->environment_data), bytes_of(buffers->corner_normals),
       bytes_of(colors.words), bytes_of(colors.materials), bytes_of(colors.texels)});
  check_memory(device.info(), need, "needs");
  result.bytes = need.total;
  buffers->node_values = bvh.nodes;
  buffers->block_values = bvh.blocks;
  buffers->segment_values = bvh.segments;
  buffers->textured_values = bvh.textured;
  buffers->nodes = share(context, bvh.nodes);
  buffers->blocks = share(context, bvh.blocks);
  buffers->segments = share(context, bvh.segments);
  buffers->textured = share(context, bvh.textured);
  share_placement(context, bvh, *buffers);
  buffers->bounds = bvh.bounds;
  buffers->materials = share(context, buffers->material_records);
  buffers->texels = share(context, buffers->texel_data);
  buffers->lights = share(context, buffers->light_records);
  buffers->emitters = share(context, buffers->emitter_triangles);
  buffers->environments = share(context, buffers->environment_data);
  buffers->normals = share(context, buffers->corner_normals);
  buffers->color_words = share(context, buffers->colors.words);
  buffers->color_materials = share(context, buffers->colors.materials);
  buffers->color_texels = share(context, buffers->colors.texels);
  context.finish();
  result.buffers = std::move(buffers);
  return result;
}

namespace {

/// As update(), for a scene that is on the device. After an Error its buffers may be of two times.
BvhUpdate update_uploaded(const Device& device, DeviceScene& on_device, UpdatableBvh& bvh,
                          const Scene& moved, const UploadOptions& options) {
  DeviceContext& context = device.context();
  DeviceBuffers& buffers = *on_device.buffers;
  BvhUpdate changes;
  {
    const std::shared_ptr<void> nodes = context.lend(buffers.nodes),
                                blocks = context.lend(buffers.blocks),
                                textured = context.lend(buffers.textured);
    changes = bvh.update(moved);
  }
  const SceneBvh& now = bvh.bvh();
  const bool new_colors = options.colors && color_key(moved) != buffers.color_key;
  if (changes.is_new || new_colors || options != buffers.uploaded) {
    on_device = {};
    on_device = upload(device, moved, now, options);
    return changes;
  }
  if (!context.shares_memory()) {
    write_ranges(context, buffers.nodes, now.nodes, changes.nodes);
    write_ranges(context, buffers.blocks, now.blocks, changes.blocks);
    if (changes.textured)
      write_ranges(context, buffers.textured, now.textured, {{0, now.textured.size()}});
  }
  buffers.bounds = now.bounds;
  if (changes.placement) share_placement(context, now, buffers);
  share_lights(context, moved, buffers);
  if (options.normals) {
    share_if_new(context, pack_normals(moved, now, options.flat_normals), buffers.corner_normals,
                 buffers.normals);
  }
  if (options.colors && changes.objects_refitted > 0 && !moved.color_textures.empty()) {
    share_if_new(context, pack_color_words(moved, now), buffers.colors.words, buffers.color_words);
  }
  context.finish();
  on_device.bytes = bytes_of_all(buffers);
  return changes;
}

}  // namespace

BvhUpdate update(const Device& device, DeviceScene& on_device, UpdatableBvh& bvh,
                 const Scene& moved, const UploadOptions& options) {
  check_lights(moved);
  if (!on_device.buffers) {
    BvhUpdate all = bvh.update(moved);
    on_device = upload(device, moved, bvh.bvh(), options);
    return all;
  }
  try {
    return update_uploaded(device, on_device, bvh, moved, options);
  } catch (...) {
    on_device = {};
    throw;
  }
}

}  // namespace dapple
