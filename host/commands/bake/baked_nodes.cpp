#include "commands/bake/baked_nodes.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "bake/samples/placed_areas.hpp"
#include "bake/samples/surface_samples.hpp"
#include "commands/bake/baked_attributes.hpp"
#include "scene/check/invertible.hpp"

namespace dapple {
namespace {

/// The attribute of EXT_mesh_gpu_instancing that engines such as three.js show as a colour: VEC3.
constexpr const char* kInstanceColor = "_COLOR_0";

/// Areas of meshes where instances place them, relative to those of others of their node.
class AreasOfMeshes {
 public:
  explicit AreasOfMeshes(const Scene& scene) : scene_(scene) {}

  double of(const Instance& instance) {
    const PlacedAreas areas(instance.to_world);
    const Mesh& mesh = scene_.meshes[instance.mesh];
    if (!areas.is_even()) return sum(mesh, areas);
    const auto [at, is_new] = even_.try_emplace(instance.mesh, 0.0);
    if (is_new) at->second = sum(mesh, areas);
    return at->second;
  }

 private:
  static double sum(const Mesh& mesh, const PlacedAreas& areas) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      if (!has_area(mesh, t)) continue;
      const V3f vector = area_vector(mesh, t);
      const float length = vector.length();
      sum += double{length} * double{areas.scale_of(vector / length)};
    }
    return sum;
  }

  const Scene& scene_;
  std::map<std::uint32_t, double> even_;  ///< by mesh, of instances that scale all axes alike
};

/// The meshes that each node places.
std::map<int, std::set<std::uint32_t>> meshes_of_nodes(const Scene& scene) {
  std::map<int, std::set<std::uint32_t>> meshes;
  for (const Instance& instance : scene.instances)
    if (instance.node >= 0 && !scene.meshes[instance.mesh].has_strands())
      meshes[instance.node].insert(instance.mesh);
  return meshes;
}

/// Values like `kind`, one or more components of value(instance, component) each. The meshes that a
/// node places together, such as its primitives that emit and those that do not, count by their
/// areas. Nodes whose instances are all scaled to zero have none.
template <class Value>
std::vector<gltf::NodeValues> means_of_nodes(const Scene& scene, const gltf::NodeValues& kind,
                                             Value value) {
  const std::map<int, std::set<std::uint32_t>> meshes = meshes_of_nodes(scene);
  AreasOfMeshes areas(scene);
  struct NodeSums {
    std::vector<double> weights, values;  // by placement; by placement and component
  };
  std::map<int, NodeSums> sums;
  std::map<std::pair<int, std::uint32_t>, std::size_t> placements;  // of a node and mesh so far
  std::set<int> placed;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.node < 0 || scene.meshes[instance.mesh].has_strands()) continue;
    if (is_invertible(instance.to_world)) placed.insert(instance.node);
    NodeSums& sum = sums[instance.node];
    const std::size_t placement = placements[{instance.node, instance.mesh}]++;
    if (sum.weights.size() <= placement) {
      sum.weights.resize(placement + 1);
      sum.values.resize(sum.weights.size() * kind.components);
    }
    // Of a node with one mesh only that counts.
    const double area = meshes.at(instance.node).size() < 2
                            ? 1.0
                            : std::max(areas.of(instance), std::numeric_limits<double>::min());
    sum.weights[placement] += area;
    for (std::size_t c = 0; c < kind.components; ++c)
      sum.values[placement * kind.components + c] += area * double{value(i, c)};
  }
  std::vector<gltf::NodeValues> nodes;
  for (const auto& [node, sum] : sums) {
    if (!placed.contains(node)) continue;
    nodes.push_back(kind);
    nodes.back().node = static_cast<std::uint32_t>(node);
    for (std::size_t i = 0; i < sum.values.size(); ++i)
      nodes.back().values.push_back(
          static_cast<float>(sum.values[i] / sum.weights[i / kind.components]));
  }
  return nodes;
}

/// Three equal components in place of one.
void make_grey(gltf::NodeValues& values) {
  std::vector<float> grey;
  for (const float value : values.values) grey.insert(grey.end(), 3, value);
  values.components = 3;
  values.values = std::move(grey);
}

}  // namespace

std::vector<gltf::NodeValues> baked_nodes(const gltf::SourceFile& file, const Scene& scene,
                                          const BakeResult& result, const std::string& attribute) {
  std::vector<gltf::NodeValues> nodes = means_of_nodes(
      scene, {{}, "ao", attribute, 1, {}},
      [&](std::size_t instance, std::size_t) { return result.instance_ao[instance]; });
  for (gltf::NodeValues& values : nodes)
    if (attribute == kInstanceColor && file.has_gpu_instances(values.node)) make_grey(values);
  for (std::size_t l = 0; l < result.instance_light.size(); ++l) {
    const std::string& name = result.light_names[l];
    for (gltf::NodeValues& values :
         means_of_nodes(scene, {{}, "light_" + name, light_attribute_name(name), 3, {}},
                        [&](std::size_t instance, std::size_t component) {
                          return result.instance_light[l][instance][static_cast<int>(component)];
                        }))
      nodes.push_back(std::move(values));
  }
  return nodes;
}

}  // namespace dapple
