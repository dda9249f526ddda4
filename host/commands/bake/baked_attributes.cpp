#include "commands/bake/baked_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bake/mesh_placements.hpp"
#include "bake/samples/surface_samples.hpp"
#include "commands/bake/file_values.hpp"
#include "dapple/error.hpp"
#include "film/light_layers.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

using gltf::NewAttribute;
using gltf::SourceFile;

/// Scales that differ by less are one scale and its rounding.
constexpr float kEqualScales = 1e-4f;

/// L L^T of the linear part L of the matrices of a mesh's placements, the mean of all, each
/// relative to its trace: directions v become normals v L L^T. It does not depend on rotations. The
/// identity where all scales are equal.
Imath::M33f metric_of(const Scene& scene, std::size_t mesh) {
  Imath::M33f sum(0.0f);
  for (const Instance& instance : scene.instances) {
    if (instance.mesh != mesh || !is_invertible(instance.to_world)) continue;
    Imath::M33f linear;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) linear[i][k] = instance.to_world[i][k];
    const Imath::M33f metric = linear * linear.transposed();
    sum += metric * (3 / (metric[0][0] + metric[1][1] + metric[2][2]));
  }
  const float mean = (sum[0][0] + sum[1][1] + sum[2][2]) / 3;
  if (!(mean > 0) || !std::isfinite(mean)) return {};
  sum /= mean;
  return sum.equalWithAbsError(Imath::M33f(), kEqualScales) ? Imath::M33f() : sum;
}

/// Bent normals as NORMAL has them, which viewers transform with the inverse transpose of matrices,
/// not as directions. Those of what is brighter from behind are mirrored, in the world, to the
/// front of their triangles: NORMAL is turned round where the back is seen. Vertices that see
/// nothing keep their normals.
BakedMesh as_normals(const Mesh& mesh, BakedMesh baked, const Imath::M33f& metric) {
  if (baked.bent.empty()) return baked;
  std::vector<V3f> normals(mesh.positions.size(), V3f(0, 0, 0));
  for (std::size_t t = 0; t < mesh.primitive_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) normals[mesh.indices[3 * t + k]] += area_vector(mesh, t);
  const Imath::M33f inverse = metric.inverse();
  for (std::size_t v = 0; v < baked.bent.size(); ++v) {
    const V3f front = normals[v].normalized(), bent = baked.bent[v];
    if (!(bent.length2() > 0)) {  // nothing is seen from there
      baked.bent[v] = mesh.normals.empty() ? front : mesh.normals[v];
      continue;
    }
    const float along = bent.dot(front);
    baked.bent[v] = bent * metric;
    if (along < 0) baked.bent[v] -= front * (2 * along / (front * inverse).dot(front));
    if (metric != Imath::M33f()) baked.bent[v].normalize();
  }
  return baked;
}

/// Whether a mesh's skinned vertices are mirrored along x, and its node mirrors them back, so that
/// their fronts are those that glTF says.
bool is_mirrored(const Mesh& mesh) {
  return std::any_of(mesh.sources.begin(), mesh.sources.end(),
                     [](const VertexSource& source) { return source.mirrored; });
}

NewAttribute color_attribute(gltf::PrimitiveColors colors, const VertexValues& baked,
                             const BakeChannel& channel, bool multiply) {
  NewAttribute attribute;
  attribute.components = colors.components == 4 || channel.components == "a" ? 4 : 3;
  if (colors.values.empty()) colors.values.assign(4 * baked.ao.size(), 1.0f);
  for (std::size_t v = 0; v < baked.ao.size(); ++v) {
    for (const char component : channel.components) {
      const std::size_t c = component == 'r' ? 0 : component == 'g' ? 1 : component == 'b' ? 2 : 3;
      float& value = colors.values[4 * v + c];
      value = multiply ? value * baked.ao[v] : baked.ao[v];
    }
    for (std::size_t c = 0; c < attribute.components; ++c)
      attribute.values.push_back(colors.values[4 * v + c]);
  }
  // The file's floats may be of any value, and too small for 16 bits.
  if (!colors.are_floats && std::all_of(attribute.values.begin(), attribute.values.end(),
                                        [](float value) { return value >= 0 && value <= 1; }))
    attribute.storage = gltf::Storage::normalized16;
  return attribute;
}

/// AO in one component of texture coordinates; the other one stays, or is 0.
NewAttribute uv_attribute(std::vector<V2f> uvs, const VertexValues& baked,
                          const BakeChannel& channel) {
  uvs.resize(baked.ao.size(), V2f(0, 0));
  NewAttribute attribute;
  attribute.components = 2;
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    uvs[v][channel.components == "x" ? 0 : 1] = baked.ao[v];
    attribute.values.insert(attribute.values.end(), {uvs[v].x, uvs[v].y});
  }
  return attribute;
}

NewAttribute bent_attribute(const VertexValues& baked, const std::string& name) {
  NewAttribute attribute;
  attribute.name = name;
  attribute.components = 3;
  for (const V3f& bent : baked.bent) {
    // Of vertices that no triangle uses, or that see nothing: glTF wants unit vectors.
    const V3f unit = bent.length2() > 0 ? bent.normalized() : V3f(0, 1, 0);
    attribute.values.insert(attribute.values.end(), {unit.x, unit.y, unit.z});
  }
  return attribute;
}

NewAttribute light_attribute(const VertexValues& baked, std::size_t light,
                             const std::string& name) {
  NewAttribute attribute;
  attribute.name = name;
  attribute.components = 3;
  for (std::size_t v = 0; v < baked.ao.size(); ++v) {
    const V3f& value = baked.light[light][v];
    attribute.values.insert(attribute.values.end(), {value.x, value.y, value.z});
  }
  return attribute;
}

NewAttribute ao_attribute(const SourceFile& file, const FilePrimitive& at,
                          const VertexValues& baked, const BakeTargets& targets) {
  const BakeChannel& channel = targets.channel;
  NewAttribute attribute;
  if (const auto set = uv_set_of(channel.attribute)) {
    attribute = uv_attribute(file.uvs(at.first, at.second, *set), baked, channel);
  } else if (channel.attribute == "COLOR_0") {
    attribute = color_attribute(file.colors(at.first, at.second), baked, channel, targets.multiply);
  } else {
    attribute.values = baked.ao;
  }
  attribute.name = channel.attribute;
  return attribute;
}

void refuse_used_uvs(const SourceFile& file, const VertexSource& source, const BakeChannel& channel,
                     std::uint32_t set) {
  const std::string texture = file.texture_with_uvs(source.mesh, source.primitive, set);
  if (texture.empty()) return;
  throw Error(
      ErrorKind::usage,
      fmt::format("--channel is {}.{}, but {}, of mesh {} primitive {}, uses {}; choose a set "
                  "that no texture uses, or an attribute such as _AO",
                  channel.attribute, channel.components, texture, source.mesh, source.primitive,
                  channel.attribute));
}

}  // namespace

std::string light_attribute_name(const std::string& light) { return "_LIGHT_" + light; }

void check_channel(const SourceFile& file, const Scene& scene, const BakeChannel& channel) {
  const auto set = uv_set_of(channel.attribute);
  if (!set) return;
  std::uint32_t most = 0;  // sets of a primitive
  for (const Mesh& mesh : scene.meshes)
    for (const VertexSource& source : mesh.sources)
      most = std::max(most, file.uv_sets(source.mesh, source.primitive));
  for (const Mesh& mesh : scene.meshes) {
    for (const VertexSource& source : mesh.sources) {
      if (!mesh.has_strands()) refuse_used_uvs(file, source, channel, *set);
      const std::uint32_t sets = file.uv_sets(source.mesh, source.primitive);
      if (*set <= sets) continue;
      throw Error(ErrorKind::usage,
                  fmt::format("--channel is {}.{}, but mesh {} primitive {} has {} set{} of "
                              "texture coordinates; TEXCOORD_{} is the next one{}",
                              channel.attribute, channel.components, source.mesh, source.primitive,
                              sets, sets == 1 ? "" : "s", sets,
                              sets == most ? ""
                                           : fmt::format(". Others have up to {}: an attribute "
                                                         "such as _AO fits all",
                                                         most)));
    }
  }
}

void check_channel_spares_lights(const BakeChannel& channel, const std::vector<Light>& lights) {
  for (const LightLayer& layer : light_layers(lights))
    if (channel.attribute == light_attribute_name(layer.name))
      throw Error(ErrorKind::usage,
                  fmt::format("--channel is {}, which is the attribute of the light \"{}\"; choose "
                              "another name, such as _AO",
                              channel.attribute, layer.name));
}

std::vector<NewAttribute> baked_attributes(const SourceFile& file, const Scene& scene,
                                           const BakeResult& result, const BakeTargets& targets) {
  const BakeChannel& channel = targets.channel;
  const bool to_normal = targets.bent_channel == "NORMAL";
  const bool any_mirrored = std::any_of(scene.meshes.begin(), scene.meshes.end(), is_mirrored);
  std::vector<BakedMesh> turned;
  for (std::size_t m = 0; (to_normal || any_mirrored) && m < result.meshes.size(); ++m) {
    turned.push_back(result.meshes[m]);
    if (to_normal) turned[m] = as_normals(scene.meshes[m], turned[m], metric_of(scene, m));
    const bool mirrored = is_mirrored(scene.meshes[m]);
    for (V3f& bent : turned[m].bent) bent.x = mirrored ? -bent.x : bent.x;
  }
  const FileValues values =
      file_values(file, scene, turned.empty() ? result.meshes : turned,
                  placement_counts(scene, targets.placement), channel.attribute);
  std::map<FileValues::SetIndex, std::vector<FilePrimitive>> users;
  for (const auto& [primitive, set] : values.primitives) users[set].push_back(primitive);
  std::vector<NewAttribute> attributes;
  std::size_t shared = 0;
  for (const auto& [set, primitives] : users) {
    const VertexValues& baked = values.sets.at(set.first)[set.second];
    const auto push = [&](NewAttribute attribute) {
      attribute.shared = shared;
      std::vector<float> stored = std::move(attribute.values);
      for (const auto& [mesh, number] : primitives) {
        attribute.mesh = mesh;
        attribute.primitive = number;
        attributes.push_back(attribute);
        attributes.back().values = std::exchange(stored, {});  // the first one's count for all
      }
    };
    push(ao_attribute(file, primitives.front(), baked, targets));
    if (!baked.bent.empty()) push(bent_attribute(baked, targets.bent_channel));
    for (std::size_t l = 0; l < baked.light.size(); ++l)
      push(light_attribute(baked, l, light_attribute_name(result.light_names[l])));
    ++shared;
  }
  return attributes;
}

bool multiplies_colors(const SourceFile& file, const Scene& scene, const BakeResult& result,
                       const BakeTargets& targets) {
  if (!targets.multiply || targets.channel.attribute != "COLOR_0") return false;
  const std::uint32_t needed = targets.channel.components == "a" ? 4 : 3;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (result.meshes[m].ao.empty()) continue;
    for (const VertexSource& source : scene.meshes[m].sources)
      if (file.colors(source.mesh, source.primitive).components >= needed) return true;
  }
  return false;
}

}  // namespace dapple
