#include "commands/baked_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "dapple/error.hpp"

namespace dapple {
namespace {

using gltf::NewAttribute;
using gltf::SourceFile;

/// Sums over the meshes of a scene that show one primitive's vertices: poses and placements.
struct VertexSums {
  std::vector<float> ao, weight;
  std::vector<V3f> bent;
  std::vector<std::vector<V3f>> light;  ///< by light
};

void add(const VertexSource& source, const BakedMesh& baked, VertexSums& sums) {
  for (std::uint32_t i = 0; i < source.count; ++i) {
    const std::uint32_t to = source.used.empty() ? i : source.used[i];
    const std::uint32_t from = source.first + i;
    sums.ao[to] += baked.ao[from];
    sums.weight[to] += 1;
    if (!baked.bent.empty()) sums.bent[to] += baked.bent[from];
    for (std::size_t l = 0; l < baked.light.size(); ++l) sums.light[l][to] += baked.light[l][from];
  }
}

NewAttribute color_attribute(gltf::PrimitiveColors colors, const VertexSums& sums,
                             const BakeChannel& channel, bool multiply) {
  NewAttribute attribute;
  attribute.storage = gltf::Storage::normalized16;
  attribute.components = colors.components == 4 || channel.components == "a" ? 4 : 3;
  if (colors.values.empty()) colors.values.assign(4 * sums.ao.size(), 1.0f);
  for (std::size_t v = 0; v < sums.ao.size(); ++v) {
    for (const char component : channel.components) {
      const std::size_t c = component == 'r' ? 0 : component == 'g' ? 1 : component == 'b' ? 2 : 3;
      float& value = colors.values[4 * v + c];
      value = multiply ? value * sums.ao[v] : sums.ao[v];
    }
    for (std::size_t c = 0; c < attribute.components; ++c)
      attribute.values.push_back(colors.values[4 * v + c]);
  }
  return attribute;
}

/// AO in one component of texture coordinates; the other one stays, or is 0.
NewAttribute uv_attribute(std::vector<V2f> uvs, const VertexSums& sums,
                          const BakeChannel& channel) {
  uvs.resize(sums.ao.size(), V2f(0, 0));
  NewAttribute attribute;
  attribute.components = 2;
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    uvs[v][channel.components == "x" ? 0 : 1] = sums.ao[v];
    attribute.values.insert(attribute.values.end(), {uvs[v].x, uvs[v].y});
  }
  return attribute;
}

NewAttribute bent_attribute(const VertexSums& sums, const std::string& name) {
  NewAttribute attribute;
  attribute.name = name;
  attribute.components = 3;
  for (const V3f& bent : sums.bent) {
    const V3f unit = bent.normalized();
    attribute.values.insert(attribute.values.end(), {unit.x, unit.y, unit.z});
  }
  return attribute;
}

NewAttribute light_attribute(const VertexSums& sums, std::size_t light, const std::string& name) {
  NewAttribute attribute;
  attribute.name = name;
  attribute.components = 3;
  for (std::size_t v = 0; v < sums.weight.size(); ++v) {
    const V3f value = sums.light[light][v] / std::max(1.0f, sums.weight[v]);
    attribute.values.insert(attribute.values.end(), {value.x, value.y, value.z});
  }
  return attribute;
}

NewAttribute ao_attribute(const SourceFile& file, std::pair<std::uint32_t, std::uint32_t> at,
                          const VertexSums& sums, const BakeTargets& targets) {
  const BakeChannel& channel = targets.channel;
  NewAttribute attribute;
  if (const auto set = uv_set_of(channel.attribute)) {
    attribute = uv_attribute(file.uvs(at.first, at.second, *set), sums, channel);
  } else if (channel.attribute == "COLOR_0") {
    attribute = color_attribute(file.colors(at.first, at.second), sums, channel, targets.multiply);
  } else {
    attribute.values = sums.ao;
  }
  attribute.name = channel.attribute;
  return attribute;
}

/// Values like `kind`, one or more components of value(instance, component) each.
template <class Value>
std::vector<gltf::NodeValues> means_of_nodes(const Scene& scene, const gltf::NodeValues& kind,
                                             Value value) {
  std::map<int, gltf::NodeValues> sums;
  std::map<int, std::vector<float>> counts;
  std::map<std::pair<int, std::uint32_t>, std::size_t> placements;  // of a node and mesh so far
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.node < 0 || scene.meshes[instance.mesh].has_strands()) continue;
    gltf::NodeValues& sum = sums.try_emplace(instance.node, kind).first->second;
    sum.node = static_cast<std::uint32_t>(instance.node);
    std::vector<float>& count = counts[instance.node];
    const std::size_t placement = placements[{instance.node, instance.mesh}]++;
    if (count.size() <= placement) {
      count.resize(placement + 1);
      sum.values.resize(count.size() * kind.components);
    }
    ++count[placement];
    for (std::size_t c = 0; c < kind.components; ++c)
      sum.values[placement * kind.components + c] += value(i, c);
  }
  std::vector<gltf::NodeValues> nodes;
  for (auto& [node, sum] : sums) {
    for (std::size_t i = 0; i < sum.values.size(); ++i)
      sum.values[i] /= std::max(1.0f, counts[node][i / kind.components]);
    nodes.push_back(std::move(sum));
  }
  return nodes;
}

}  // namespace

void check_channel(const SourceFile& file, const Scene& scene, const BakeChannel& channel) {
  const auto set = uv_set_of(channel.attribute);
  if (!set) return;
  for (const Mesh& mesh : scene.meshes) {
    for (const VertexSource& source : mesh.sources) {
      const std::uint32_t sets = file.uv_sets(source.mesh, source.primitive);
      if (*set <= sets) continue;
      throw Error(ErrorKind::usage,
                  fmt::format("--channel is {}.{}, but mesh {} primitive {} has {} sets of texture "
                              "coordinates; TEXCOORD_{} is the next one",
                              channel.attribute, channel.components, source.mesh, source.primitive,
                              sets, sets));
    }
  }
}

std::vector<NewAttribute> baked_attributes(const SourceFile& file, const Scene& scene,
                                           const BakeResult& result, const BakeTargets& targets) {
  const BakeChannel& channel = targets.channel;
  const std::vector<BakedMesh>& meshes = result.meshes;
  // Primitives may share their vertices.
  std::map<gltf::VertexKey, VertexSums> sums;
  std::map<std::pair<std::uint32_t, std::uint32_t>, gltf::VertexKey> primitives;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].ao.empty()) continue;
    for (const VertexSource& source : scene.meshes[m].sources) {
      const gltf::VertexKey key = file.vertex_key(source.mesh, source.primitive, channel.attribute);
      primitives[{source.mesh, source.primitive}] = key;
      VertexSums& of = sums[key];
      const std::size_t count = file.vertex_count(source.mesh, source.primitive);
      of.ao.resize(count);
      of.weight.resize(count);
      if (!meshes[m].bent.empty()) of.bent.resize(count, V3f(0));
      of.light.resize(meshes[m].light.size());
      for (std::vector<V3f>& light : of.light) light.resize(count, V3f(0));
      add(source, meshes[m], of);
    }
  }
  for (auto& [key, of] : sums)
    for (std::size_t v = 0; v < of.ao.size(); ++v)
      of.ao[v] = of.weight[v] > 0 ? of.ao[v] / of.weight[v] : 1.0f;
  std::vector<NewAttribute> attributes;
  const auto push = [&](NewAttribute attribute, const auto& primitive) {
    attribute.mesh = primitive.first;
    attribute.primitive = primitive.second;
    attributes.push_back(std::move(attribute));
  };
  for (const auto& [primitive, key] : primitives) {
    const VertexSums& of = sums[key];
    push(ao_attribute(file, primitive, of, targets), primitive);
    if (!of.bent.empty()) push(bent_attribute(of, targets.bent_channel), primitive);
    for (std::size_t l = 0; l < of.light.size(); ++l)
      push(light_attribute(of, l, "_LIGHT_" + result.light_names[l]), primitive);
  }
  return attributes;
}

std::vector<gltf::NodeValues> baked_nodes(const Scene& scene, const BakeResult& result) {
  std::vector<gltf::NodeValues> nodes = means_of_nodes(
      scene, {{}, "ao", "_AO", 1, {}},
      [&](std::size_t instance, std::size_t) { return result.instance_ao[instance]; });
  for (std::size_t l = 0; l < result.instance_light.size(); ++l) {
    const std::string& name = result.light_names[l];
    for (gltf::NodeValues& values :
         means_of_nodes(scene, {{}, "light_" + name, "_LIGHT_" + name, 3, {}},
                        [&](std::size_t instance, std::size_t component) {
                          return result.instance_light[l][instance][static_cast<int>(component)];
                        }))
      nodes.push_back(std::move(values));
  }
  return nodes;
}

}  // namespace dapple
