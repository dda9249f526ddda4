// Pictures: render() and its film as arrays.
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "dapple/film.hpp"
#include "dapple/render.hpp"
#include "engine_call.hpp"
#include "nanobind/stl/map.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

RenderResult render_picture(const SceneOnDevice& scene, const RenderOptions& options,
                            const nb::object& progress) {
  const auto kept = scene.scene();
  return call_engine(progress,
                     [&](const RenderControl& control) { return render(*kept, options, control); });
}

/// The pixels of a channel, (height, width), as a view of the film.
nb::ndarray<const float, nb::numpy> pixels(nb::handle_t<RenderResult> picture,
                                           const std::string& channel) {
  const Film& film = nb::cast<const RenderResult&>(picture).film;
  const Plane* plane = film.find(channel);
  if (plane == nullptr) throw nb::key_error(channel.c_str());
  const auto height = static_cast<std::size_t>(film.data_window.height());
  const auto width = static_cast<std::size_t>(film.data_window.width());
  return {plane->pixels.data(), {height, width}, picture};
}

std::vector<std::string> channels(const RenderResult& picture) {
  std::vector<std::string> names;
  for (const Plane& plane : picture.film.planes) names.push_back(plane.channel);
  return names;
}

std::vector<std::pair<std::string, std::string>> metadata(const RenderResult& picture) {
  const FilmMetadata& m = picture.film.metadata;
  std::vector<std::pair<std::string, std::string>> all = m.settings;
  all.insert(all.end(), m.attributes.begin(), m.attributes.end());
  all.emplace_back("scene", m.scene);
  all.emplace_back("device", m.device);
  all.emplace_back("version", m.version);
  return all;
}

}  // namespace

void bind_pictures(nb::module_& module) {
  nb::class_<RenderResult>(module, "Picture")
      .def("pixels", pixels, nb::arg("channel"))
      .def_prop_ro("channels", channels)
      .def_prop_ro("metadata", metadata)
      .def_prop_ro("notes", [](const RenderResult& r) { return r.statistics.notes; })
      .def_prop_ro("rmse", [](const RenderResult& r) { return r.statistics.rmse; })
      .def_prop_ro("seconds", [](const RenderResult& r) { return r.statistics.seconds.total; })
      .def(
          "write_exr",
          [](const RenderResult& r, const std::string& path) { write_exr(r.film, path); },
          nb::arg("path"))
      .def(
          "write_png",
          [](const RenderResult& r, const std::string& path, const std::string& layer) {
            write_png(r.film, path, layer);
          },
          nb::arg("path"), nb::arg("layer"));
  module.def("render", render_picture, nb::arg("scene"), nb::arg("options"),
             nb::arg("progress").none());
}

}  // namespace dapple::python
