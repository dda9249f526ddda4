// Queries at points: ambient occlusion, irradiance, and measure_points() with all its columns.
#include "dapple/points.hpp"

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bias.hpp"
#include "bindings.hpp"
#include "dapple/render.hpp"
#include "engine_call.hpp"
#include "film/layers.hpp"
#include "nanobind/stl/map.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/tuple.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

FloatsOut occlusion_at(SceneOnDevice& scene, const VectorsIn& points, const VectorsIn& normals,
                       const OcclusionOptions& options, const std::string& device,
                       const nb::object& progress) {
  SceneOnDevice::Query query = scene.query(device);
  std::vector<float> found = call_engine(progress, [&](const RenderControl& control) {
    const Uploaded& on = query.upload();
    return occlusion(on.device, on.on_device, vectors(points), vectors(normals), options, control);
  });
  scene.keep(query);
  return array_of(std::move(found));
}

/// For each light its name, irradiance and unoccluded irradiance, (n, 3) each.
using NamedIrradiance = std::vector<std::pair<std::string, std::pair<FloatsOut, FloatsOut>>>;

NamedIrradiance irradiance_at(SceneOnDevice& scene, const VectorsIn& points,
                              const VectorsIn& normals, const IrradianceOptions& options,
                              const std::string& device, const nb::object& progress) {
  SceneOnDevice::Query query = scene.query(device);
  std::vector<PointIrradiance> found = call_engine(progress, [&](const RenderControl& control) {
    const Uploaded& on = query.upload();
    return irradiance(on.device, on.on_device, on.scene.lights, vectors(points), vectors(normals),
                      options, control);
  });
  scene.keep(query);
  const std::vector<std::string> names = light_names(query.uploaded->scene.lights);
  NamedIrradiance result;
  for (std::size_t i = 0; i < found.size(); ++i)
    result.push_back(
        {names[i],
         {array_of(std::move(found[i].irradiance)), array_of(std::move(found[i].unoccluded))}});
  return result;
}

/// The columns, the bias by quantity, the footprint, notes.
using Measured = std::tuple<std::vector<std::pair<std::string, FloatsOut>>,
                            std::map<std::string, BiasFields>, float, std::vector<std::string>>;

/// `suns`: a direction and an irradiance each.
Measured measure_at(const SceneOnDevice& scene, const VectorsIn& points, const VectorsIn& normals,
                    PointOptions options, const VectorsIn& suns, const FloatsIn& sun_irradiance,
                    const nb::object& progress) {
  const std::span<const V3f> directions = vectors(suns);
  for (std::size_t i = 0; i < directions.size(); ++i)
    options.suns.push_back({directions[i], sun_irradiance.data()[i]});
  const auto kept = scene.scene();
  PointResult found = call_engine(progress, [&](const RenderControl& control) {
    return measure_points(*kept, vectors(points), vectors(normals), options, control);
  });
  std::vector<std::pair<std::string, FloatsOut>> columns;
  for (PointColumn& column : found.columns)
    columns.emplace_back(column.name, array_of(std::move(column.values)));
  return {std::move(columns), bias_fields(found.bias), found.footprint, std::move(found.notes)};
}

}  // namespace

void bind_points(nb::module_& module) {
  module.def("occlusion", occlusion_at, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
             nb::arg("options"), nb::arg("device"), nb::arg("progress").none());
  module.def("irradiance", irradiance_at, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
             nb::arg("options"), nb::arg("device"), nb::arg("progress").none());
  module.def("measure", measure_at, nb::arg("scene"), nb::arg("points"), nb::arg("normals"),
             nb::arg("options"), nb::arg("suns"), nb::arg("sun_irradiance"),
             nb::arg("progress").none());
}

}  // namespace dapple::python
