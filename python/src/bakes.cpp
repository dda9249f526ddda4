// Bakes: values at vertices and of instances, as arrays.
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "dapple/bake.hpp"
#include "engine_call.hpp"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/tuple.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

using NamedArrays = std::vector<std::pair<std::string, FloatsOut>>;

/// For each mesh its arrays, the AO of the instances, their irradiance by light, and notes.
using Baked =
    std::tuple<std::vector<NamedArrays>, FloatsOut, NamedArrays, std::vector<std::string>>;

Baked bake_scene(const SceneOnDevice& scene, const BakeOptions& options,
                 const std::vector<const SceneOnDevice*>& occluders, const nb::object& progress) {
  const auto kept = scene.scene();
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
  return {std::move(meshes), array_of(std::move(found.instance_ao)), std::move(instance_light),
          std::move(found.statistics.notes)};
}

}  // namespace

void bind_bakes(nb::module_& module) {
  module.def("bake", bake_scene, nb::arg("scene"), nb::arg("options"), nb::arg("occluders"),
             nb::arg("progress").none());
}

}  // namespace dapple::python
