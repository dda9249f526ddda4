#include "bvh/storage/object_key.hpp"

#include <vector>

namespace dapple {
namespace {

std::vector<bool> used_materials(const Scene& scene, const Mesh& mesh) {
  std::vector<bool> used(scene.materials.size(), false);
  for (const std::uint32_t material : mesh.materials) used[material] = true;
  return used;
}

/// Texture coordinates that only colours need are no part of an object.
bool has_alpha_texture(const Scene& scene, const std::vector<bool>& used) {
  for (std::size_t m = 0; m < used.size(); ++m)
    if (used[m] && scene.materials[m].alpha_texture >= 0) return true;
  return false;
}

void add_texture(ChecksumStream& key, const Texture& texture) {
  key.add_value(texture.width);
  key.add_value(texture.height);
  key.add_value(texture.wrap_s);
  key.add_value(texture.wrap_t);
  key.add_value(static_cast<std::uint8_t>(texture.nearest));
  key.add_range(texture.alpha);
}

/// Adds the opacity of the material, the index of its texture, and the texture.
void add_material(ChecksumStream& key, const Scene& scene, const Material& material) {
  key.add_value(material.alpha_mode);
  key.add_value(material.alpha);
  key.add_value(material.alpha_cutoff);
  key.add_value(static_cast<std::uint8_t>(material.uses_vertex_alpha));
  key.add_value(material.alpha_texture);
  if (material.alpha_texture >= 0) add_texture(key, scene.textures[material.alpha_texture]);
}

/// Adds everything except positions.
void add_form(ChecksumStream& key, const Scene& scene, const Mesh& mesh) {
  key.add_range(mesh.indices);
  key.add_range(mesh.materials);
  key.add_range(mesh.radii);
  key.add_range(mesh.vertex_alpha);
  const std::vector<bool> used = used_materials(scene, mesh);
  if (has_alpha_texture(scene, used)) key.add_range(mesh.uvs);
  for (std::size_t m = 0; m < used.size(); ++m) {
    if (!used[m]) continue;
    key.add_value(static_cast<std::uint64_t>(m));
    add_material(key, scene, scene.materials[m]);
  }
}

}  // namespace

Checksum object_key(const Scene& scene, const Mesh& mesh) {
  ChecksumStream key;
  key.add_range(mesh.positions);
  add_form(key, scene, mesh);
  return key.value();
}

Checksum form_key(const Scene& scene, const Mesh& mesh) {
  ChecksumStream key;
  key.add_value(static_cast<std::uint64_t>(mesh.positions.size()));
  add_form(key, scene, mesh);
  return key.value();
}

Checksum position_key(const Mesh& mesh) {
  ChecksumStream key;
  key.add_range(mesh.positions);
  return key.value();
}

}  // namespace dapple
