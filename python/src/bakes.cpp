// Bakes: values at vertices, of instances and in a texture, as arrays.
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bias.hpp"
#include "bindings.hpp"
#include "dapple/bake.hpp"
#include "engine_call.hpp"
#include "nanobind/stl/map.h"
#include "nanobind/stl/optional.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/tuple.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

using NamedArrays = std::vector<std::pair<std::string, FloatsOut>>;

/// The layers, for each mesh the texture coordinates of its triangles' corners, the coverage
/// and the overlap.
using Texture = std::tuple<NamedArrays, std::vector<FloatsOut>, double, double>;

/// For each mesh its arrays, the AO of the instances, their irradiance by light, the texture,
/// notes, the bias by layer, the footprint.
using Baked = std::tuple<std::vector<NamedArrays>, FloatsOut, NamedArrays, std::optional<Texture>,
                         std::vector<std::string>, std::map<std::string, BiasFields>, float>;

Texture texture_of(BakedTexture texture, const std::vector<std::string>& light_names) {
  const std::size_t size = texture.size;
  NamedArrays layers;
  layers.emplace_back("ao", array_of<float>(std::move(texture.ao), {size, size}));
  if (!texture.bent.empty())
    layers.emplace_back("bent", array_of<float>(std::move(texture.bent), {size, size, 3}));
  for (std::size_t i = 0; i < texture.light.size(); ++i)
    layers.emplace_back("light." + light_names[i],
                        array_of<float>(std::move(texture.light[i]), {size, size, 3}));
  std::vector<FloatsOut> corners;
  for (std::vector<V2f>& of_mesh : texture.layout.corners) {
    const std::size_t triangles = of_mesh.size() / 3;
    corners.push_back(array_of<float>(std::move(of_mesh), {triangles, 3, 2}));
  }
  return {std::move(layers), std::move(corners), texture.coverage, texture.overlap};
}

Baked bake_scene(const SceneOnDevice& scene, BakeOptions options,
                 const std::vector<CoordinatesIn>& texture_uvs,
                 const std::vector<const SceneOnDevice*>& occluders, const nb::object& progress) {
  const auto kept = scene.scene();
  for (const CoordinatesIn& uvs : texture_uvs) {
    std::vector<V2f>& of_mesh = options.texture_uvs.emplace_back();
    for (std::size_t i = 0; i < uvs.shape(0); ++i)
      of_mesh.emplace_back(uvs.data()[2 * i], uvs.data()[2 * i + 1]);
  }
  std::vector<Scene> others;
  for (const SceneOnDevice* other : occluders) others.push_back(*other->scene());
  BakeResult found = call_engine(progress, [&](const RenderControl& control) {
    return bake(*kept, options, control, others);
  });
  std::vector<NamedArrays> meshes;
  for (BakedMesh& mesh : found.meshes) {
    NamedArrays& named = meshes.emplace_back();
    if (!mesh.ao.empty()) named.emplace_back("ao", array_of(std::move(mesh.ao)));
    if (!mesh.bent.empty()) named.emplace_back("bent", array_of(std::move(mesh.bent)));
    for (std::size_t i = 0; i < mesh.light.size(); ++i)
      named.emplace_back("light." + found.light_names[i], array_of(std::move(mesh.light[i])));
  }
  NamedArrays instance_light;
  for (std::size_t i = 0; i < found.instance_light.size(); ++i)
    instance_light.emplace_back(found.light_names[i], array_of(std::move(found.instance_light[i])));
  std::optional<Texture> texture;
  if (found.texture.size > 0) texture = texture_of(std::move(found.texture), found.light_names);
  return {std::move(meshes),
          array_of(std::move(found.instance_ao)),
          std::move(instance_light),
          std::move(texture),
          std::move(found.statistics.notes),
          bias_fields(found.statistics.bias),
          found.statistics.footprint};
}

}  // namespace

void bind_bakes(nb::module_& module) {
  module.def("bake", bake_scene, nb::arg("scene"), nb::arg("options"), nb::arg("texture_uvs"),
             nb::arg("occluders"), nb::arg("progress").none());
}

}  // namespace dapple::python
