#include "bake/bake_settings.hpp"

#include <fmt/format.h>

#include "device/programs/kernel_source.hpp"
#include "files/checksum.hpp"

namespace dapple {
namespace {

std::string name_of(BakeSides sides) {
  switch (sides) {
    case BakeSides::automatic:
      return "auto";
    case BakeSides::front:
      return "front";
    case BakeSides::max:
      return "max";
    case BakeSides::mean:
      return "mean";
  }
  return "";
}

std::string name_of(BakePlacement instances) {
  return instances == BakePlacement::alone ? "alone" : "together or unique";
}

void add_vector(ChecksumStream& stream, const V3f& v) {
  for (const float value : {v.x, v.y, v.z}) stream.add_value(value);
}

void add_material(ChecksumStream& stream, const Material& material) {
  stream.add_range(material.name);
  stream.add_value(material.alpha_mode);
  stream.add_value(material.alpha);
  stream.add_value(material.alpha_cutoff);
  stream.add_value(material.alpha_texture);
  stream.add_value(material.uses_vertex_alpha);
  stream.add_value(material.double_sided);
  add_vector(stream, material.emission);
}

void add_light(ChecksumStream& stream, const Light& light) {
  stream.add_range(light.name);
  stream.add_range(light.group);
  stream.add_value(light.sequence);
  stream.add_value(light.kind);
  for (const V3f& v : {light.radiance, light.position, light.direction, light.edge_u, light.edge_v})
    add_vector(stream, v);
  for (const float value :
       {light.radius, light.angular_radius, light.cos_inner, light.cos_outer, light.rotation})
    stream.add_value(value);
  stream.add_value(light.double_sided);
  if (!light.environment) return;
  stream.add_value(light.environment->width);
  stream.add_range(light.environment->radiance);
}

void add_scene(ChecksumStream& stream, const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    stream.add_range(mesh.positions);
    stream.add_range(mesh.indices);
    stream.add_range(mesh.materials);
    stream.add_range(mesh.radii);
    stream.add_range(mesh.uvs);
    stream.add_range(mesh.vertex_alpha);
    stream.add_range(mesh.normals);
  }
  for (const Instance& instance : scene.instances) {
    stream.add_value(instance.mesh);
    stream.add_value(instance.light);
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) stream.add_value(instance.to_world[row][column]);
  }
  for (const Material& material : scene.materials) add_material(stream, material);
  for (const Texture& texture : scene.textures) {
    stream.add_value(texture.width);
    stream.add_value(texture.wrap_s);
    stream.add_value(texture.wrap_t);
    stream.add_value(texture.nearest);
    stream.add_range(texture.alpha);
  }
}

template <class Add>
std::string checksum_of(Add add) {
  ChecksumStream stream;
  add(stream);
  return hex_text(stream.value());
}

/// Where the values are, and of which kinds.
std::string contents(const BakeOptions& o) {
  std::vector<std::string> words{"ao"};
  const std::pair<bool, const char*> all[] = {{o.vertices, "vertex"},
                                              {o.texture, "texture"},
                                              {o.instances, "instance"},
                                              {o.bent, "bent"},
                                              {o.light, "light"}};
  for (const auto& [is_wanted, word] : all)
    if (is_wanted) words.emplace_back(word);
  return fmt::format("{}", fmt::join(words, ","));
}

}  // namespace

Settings bake_settings(const Scene& scene, const BakeOptions& o,
                       const std::vector<Scene>& occluders) {
  const auto number = [](auto value) { return fmt::format("{}", value); };
  std::string opacities;
  for (const auto& [material, value] : o.opacity)
    opacities += fmt::format("{}={} ", material, value);
  return {
      {"--to and --passes", contents(o)},
      {"--target-error", number(o.target_error)},
      {"--rays", number(o.rays)},
      {"--light-rays", number(o.light_rays)},
      {"--estimator", name_of(o.estimator)},
      {"--footprint", number(o.footprint)},
      {"--max-bias", number(o.max_bias)},
      {"--ao-distance", number(o.distance)},
      {"--ao-falloff", number(o.falloff)},
      {"--at", o.at_vertices ? "vertices" : "triangles"},
      {"--sides", name_of(o.sides)},
      {"--instances", name_of(o.placement)},
      {"--size", number(o.texture_size)},
      {"--margin", number(o.margin)},
      {"--normals", name_of(o.normals)},
      {"--seed", number(o.seed)},
      {"--ground", o.ground ? "a plane" : "none"},
      {"--opacity", opacities},
      {"texture coordinates (--uv)", checksum_of([&](ChecksumStream& stream) {
         for (const auto& uvs : o.texture_uvs) stream.add_range(uvs);
       })},
      {"scene", checksum_of([&](ChecksumStream& stream) { add_scene(stream, scene); })},
      {"--occluders", checksum_of([&](ChecksumStream& stream) {
         for (const Scene& other : occluders) add_scene(stream, other);
       })},
      {"lights", checksum_of([&](ChecksumStream& stream) {
         if (!o.light) return;
         for (const Light& light : o.lights ? *o.lights : scene.lights) add_light(stream, light);
       })},
      {"version of dapple", DAPPLE_VERSION},
      {"kernels", kernel_checksum(o.kernel_dir)},
  };
}

}  // namespace dapple
