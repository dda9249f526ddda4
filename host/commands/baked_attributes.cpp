#include "commands/baked_attributes.hpp"

#include <algorithm>
#include <map>

namespace dapple {
namespace {

using gltf::NewAttribute;
using gltf::SourceFile;

/// Sums over the meshes of a scene that show one primitive's vertices: poses and placements.
struct VertexSums {
  std::vector<float> ao, weight;
  std::vector<V3f> bent;
};

void add(const VertexSource& source, const BakedMesh& baked, VertexSums& sums) {
  for (std::uint32_t i = 0; i < source.count; ++i) {
    const std::uint32_t to = source.used.empty() ? i : source.used[i];
    const std::uint32_t from = source.first + i;
    sums.ao[to] += baked.ao[from];
    sums.weight[to] += 1;
    if (!baked.bent.empty()) sums.bent[to] += baked.bent[from];
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

NewAttribute bent_attribute(const VertexSums& sums) {
  NewAttribute attribute;
  attribute.name = "_BENT_NORMAL";
  attribute.components = 3;
  for (const V3f& bent : sums.bent) {
    const V3f unit = bent.normalized();
    attribute.values.insert(attribute.values.end(), {unit.x, unit.y, unit.z});
  }
  return attribute;
}

}  // namespace

std::vector<NewAttribute> baked_attributes(const SourceFile& file, const Scene& scene,
                                           const std::vector<BakedMesh>& meshes,
                                           const BakeChannel& channel, bool multiply) {
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
    if (channel.attribute == "COLOR_0") {
      NewAttribute color =
          color_attribute(file.colors(primitive.first, primitive.second), of, channel, multiply);
      color.name = channel.attribute;
      push(std::move(color), primitive);
    } else {
      NewAttribute own;
      own.name = channel.attribute;
      own.values = of.ao;
      push(std::move(own), primitive);
    }
    if (!of.bent.empty()) push(bent_attribute(of), primitive);
  }
  return attributes;
}

std::vector<gltf::NodeValues> baked_nodes(const Scene& scene, const std::vector<float>& ao) {
  struct Sum {
    std::vector<float> ao, count;
  };
  std::map<int, Sum> sums;
  std::map<std::pair<int, std::uint32_t>, std::size_t> placements;  // of a node and mesh so far
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.node < 0 || scene.meshes[instance.mesh].has_strands()) continue;
    Sum& sum = sums[instance.node];
    const std::size_t placement = placements[{instance.node, instance.mesh}]++;
    if (sum.ao.size() <= placement) {
      sum.ao.resize(placement + 1);
      sum.count.resize(placement + 1);
    }
    sum.ao[placement] += ao[i];
    sum.count[placement] += 1;
  }
  std::vector<gltf::NodeValues> nodes;
  for (auto& [node, sum] : sums) {
    for (std::size_t i = 0; i < sum.ao.size(); ++i) sum.ao[i] /= std::max(1.0f, sum.count[i]);
    nodes.push_back({static_cast<std::uint32_t>(node), std::move(sum.ao)});
  }
  return nodes;
}

}  // namespace dapple
