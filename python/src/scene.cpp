// Scenes: read from files, made from arrays, and their parts as arrays.
#include "dapple/scene.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "dapple/error.hpp"
#include "dapple/points.hpp"
#include "engine_call.hpp"
#include "film/layers.hpp"
#include "nanobind/stl/array.h"
#include "nanobind/stl/optional.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

using Vector = std::array<float, 3>;

constexpr float kLargestRadiance = 1e30f;  // W/(sr m^2): that of dapple's lights

V3f to_vector(const Vector& v) { return {v[0], v[1], v[2]}; }
Vector from_vector(const V3f& v) { return {v.x, v.y, v.z}; }

SceneOnDevice load(const std::string& path, std::optional<double> time,
                   const std::string& animation, bool allow_outside, float light_radius,
                   float line_radius) {
  SceneOptions options;
  options.light_radius = light_radius;
  options.line_radius = line_radius;
  options.time = time;
  options.animation = animation;
  options.allow_outside = allow_outside;
  options.colors = true;
  const nb::gil_scoped_release released;
  return SceneOnDevice(load_scene(path, options));
}

/// One mesh with one instance. `known`: names and opacities of materials; `materials` says which
/// one a triangle has.
SceneOnDevice from_arrays(const VectorsIn& vertices, const IndicesIn& triangles,
                          const std::vector<std::pair<std::string, float>>& known,
                          const IndicesIn& materials) {
  Scene scene;
  scene.source = "arrays";
  for (const auto& [name, opacity] : known) {
    Material material;
    material.name = name;
    material.alpha_mode = opacity < 1 ? AlphaMode::blend : AlphaMode::opaque;
    material.alpha = opacity;
    material.double_sided = true;
    scene.materials.push_back(material);
  }
  Mesh mesh;
  mesh.name = "mesh";
  const std::span<const V3f> positions = vectors(vertices);
  mesh.positions.assign(positions.begin(), positions.end());
  mesh.indices.assign(triangles.data(), triangles.data() + triangles.size());
  mesh.materials.assign(materials.data(), materials.data() + materials.size());
  if (mesh.materials.size() * 3 != mesh.indices.size())
    throw Error(ErrorKind::usage, "three indices and one material belong to each triangle");
  for (const std::uint32_t index : mesh.indices)
    if (index >= mesh.positions.size())
      throw Error(ErrorKind::usage, "triangles has the index " + std::to_string(index) +
                                        ", but there are only " +
                                        std::to_string(mesh.positions.size()) + " vertices");
  for (const std::uint32_t index : mesh.materials)
    if (index >= scene.materials.size())
      throw Error(ErrorKind::usage, "there is no material " + std::to_string(index));
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({});
  return SceneOnDevice(std::move(scene));
}

/// Values of the scene as an array that keeps the scene alive; read-only.
template <class Number, class Value>
auto view(const std::shared_ptr<const Scene>& scene, const std::vector<Value>& values,
          std::size_t columns) {
  auto* kept = new std::shared_ptr<const Scene>(scene);
  nb::capsule owner(kept,
                    [](void* p) noexcept { delete static_cast<std::shared_ptr<const Scene>*>(p); });
  const std::size_t rows = values.size() * (sizeof(Value) / sizeof(Number)) / columns;
  return nb::ndarray<const Number, nb::numpy>(reinterpret_cast<const Number*>(values.data()),
                                              {rows, columns}, owner);
}

const Mesh& mesh_of(const Scene& scene, std::size_t index) {
  if (index >= scene.meshes.size())
    throw Error(ErrorKind::usage, "there is no mesh " + std::to_string(index) + "; there are " +
                                      std::to_string(scene.meshes.size()));
  return scene.meshes[index];
}

void add_sun(Scene& scene, const Vector& towards, float irradiance, float degrees,
             const std::string& name) {
  const V3f given = to_vector(towards);
  const Imath::V3d direction = Imath::V3d(given).normalized();  // a float's square may overflow
  if (!std::isfinite(direction.length()) || !(direction.length() > 0))
    throw Error(ErrorKind::usage, "direction has no length");
  if (!(degrees > 0) || !(degrees < 180))
    throw Error(ErrorKind::usage, "angular_diameter must be above 0 and below 180 degrees");
  if (!(irradiance >= 0) || !std::isfinite(irradiance))
    throw Error(ErrorKind::usage, "irradiance must be 0 or more, and finite");
  Light light;
  light.name = name;
  light.kind = LightKind::sun;
  light.direction = -V3f(direction);
  light.angular_radius = degrees * 0.5f * 3.14159265f / 180;
  const float sine = std::sin(light.angular_radius);
  light.radiance = V3f(irradiance / (3.14159265f * sine * sine));
  if (!(light.radiance.x <= kLargestRadiance))
    throw Error(ErrorKind::usage, "irradiance is too large for so small an angular_diameter");
  scene.lights.push_back(light);
}

/// `rotation`: degrees, from +Z towards +X.
void add_sky(Scene& scene, const std::string& kind, float irradiance, double rotation) {
  Light sky;
  if (kind == "uniform" || kind == "overcast") {
    sky = kind == "uniform" ? uniform_sky() : overcast_sky();
  } else {
    sky = dome_light("sky", kind);
  }
  sky.radiance *= irradiance;
  if (!(sky.radiance.x <= kLargestRadiance))
    throw Error(ErrorKind::usage, "irradiance is too large: radiances may be up to 1e30");
  sky.rotation = static_cast<float>(std::remainder(rotation, 360.0) * 3.141592653589793 / 180);
  // First, so that results under its name are its own, as those of dapple points --sky are.
  const bool is_taken = std::any_of(scene.lights.begin(), scene.lights.end(),
                                    [&](const Light& light) { return light.name == sky.name; });
  if (is_taken)
    scene.warnings.push_back(
        "results called sky are of the sky that was added last; other lights "
        "of that name have a number");
  scene.lights.insert(scene.lights.begin(), sky);
  for (Instance& instance : scene.instances) instance.light += instance.light >= 0 ? 1 : 0;
}

void bind_parts(nb::class_<SceneOnDevice>& bound) {
  bound.def_prop_ro("source", [](const SceneOnDevice& s) { return s.scene()->source; })
      .def_prop_ro("warnings", [](const SceneOnDevice& s) { return s.scene()->warnings; })
      .def_prop_ro("mesh_names",
                   [](const SceneOnDevice& s) {
                     std::vector<std::string> names;
                     for (const Mesh& mesh : s.scene()->meshes) names.push_back(mesh.name);
                     return names;
                   })
      .def_prop_ro("material_names",
                   [](const SceneOnDevice& s) {
                     std::vector<std::string> names;
                     for (const Material& m : s.scene()->materials) names.push_back(m.name);
                     return names;
                   })
      .def_prop_ro("light_names",
                   [](const SceneOnDevice& s) { return light_names(s.scene()->lights); })
      .def_prop_ro("bounds",
                   [](const SceneOnDevice& s) {
                     const Box3f box = scene_bounds(*s.scene());
                     return std::vector<Vector>{from_vector(box.min), from_vector(box.max)};
                   })
      .def("positions",
           [](const SceneOnDevice& s, std::size_t mesh) {
             const auto scene = s.scene();
             return view<float>(scene, mesh_of(*scene, mesh).positions, 3);
           })
      .def("indices",
           [](const SceneOnDevice& s, std::size_t mesh) {
             const auto scene = s.scene();
             const Mesh& found = mesh_of(*scene, mesh);
             return view<std::uint32_t>(scene, found.indices, found.has_strands() ? 2 : 3);
           })
      .def("instances", [](const SceneOnDevice& s, std::size_t mesh) {
        std::vector<float> matrices;  // column vectors, as NumPy users write them: p' = M p
        const auto scene = s.scene();
        mesh_of(*scene, mesh);
        for (const Instance& instance : scene->instances) {
          if (instance.mesh != mesh) continue;
          for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
              matrices.push_back(instance.to_world[column][row]);
        }
        const std::size_t count = matrices.size() / 16;
        return array_of<float>(std::move(matrices), {count, 4, 4});
      });
}

/// Adds lights of a file. Their sequences of random numbers are those after the scene's.
void add_lights(Scene& scene, std::vector<Light> lights) {
  int next = 0;
  for (const Light& light : scene.lights)
    next = std::max(next, (light.sequence < 0 ? next : light.sequence) + 1);
  for (Light& light : lights) {
    light.sequence += next;
    scene.lights.push_back(std::move(light));
  }
}

}  // namespace

void bind_scene(nb::module_& module) {
  nb::class_<SceneOnDevice> bound(module, "Scene");
  bind_parts(bound);
  bound
      .def(
          "override_opacity",
          [](SceneOnDevice& s, const std::string& material, float value) {
            override_opacity(s.change(), material, value);
          },
          nb::arg("material"), nb::arg("value"))
      .def("copy", [](const SceneOnDevice& s) { return s; })  // changes do not reach the other
      .def("add_ground", [](SceneOnDevice& s) { add_ground(s.change()); })
      .def("clear_lights", [](SceneOnDevice& s) { use_lights(s.change(), {}); })
      .def(
          "add_lights",
          [](SceneOnDevice& s, const std::string& path) {
            add_lights(s.change(), load_lights(path));
          },
          nb::arg("path"))
      .def(
          "add_sun",
          [](SceneOnDevice& s, const Vector& direction, float irradiance, float angular_diameter,
             const std::string& name) {
            add_sun(s.change(), direction, irradiance, angular_diameter, name);
          },
          nb::arg("direction"), nb::arg("irradiance"), nb::arg("angular_diameter"), nb::arg("name"))
      .def(
          "add_sky",
          [](SceneOnDevice& s, const std::string& kind, float irradiance, double rotation) {
            add_sky(s.change(), kind, irradiance, rotation);
          },
          nb::arg("kind"), nb::arg("irradiance"), nb::arg("rotation"))
      .def(
          "write_glb",
          [](const SceneOnDevice& s, const std::string& path) {
            const auto scene = s.scene();
            const nb::gil_scoped_release released;
            write_glb(*scene, path);
          },
          nb::arg("path"));
  module.def("load", load, nb::arg("path"), nb::arg("time").none(), nb::arg("animation"),
             nb::arg("allow_outside"), nb::arg("light_radius"), nb::arg("line_radius"));
  module.def("from_arrays", from_arrays, nb::arg("vertices"), nb::arg("triangles"),
             nb::arg("known"), nb::arg("materials"));
}

}  // namespace dapple::python
