// Pictures: render() and its film as arrays.
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bias.hpp"
#include "bindings.hpp"
#include "dapple/error.hpp"
#include "dapple/film.hpp"
#include "dapple/render.hpp"
#include "engine_call.hpp"
#include "names.hpp"
#include "nanobind/stl/array.h"
#include "nanobind/stl/map.h"
#include "nanobind/stl/optional.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/tuple.h"
#include "nanobind/stl/vector.h"
#include "scene_on_device.hpp"

namespace dapple::python {
namespace {

RenderResult render_picture(const SceneOnDevice& scene, const RenderOptions& options,
                            const nb::object& progress) {
  const auto kept = scene.scene();
  return call_engine(progress, [&](const RenderControl& control) {
    return Renderer(open_device(options.device)).render(*kept, options, control);
  });
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

constexpr Names<ExrCompression, 5> kCompressions{{{"zip", ExrCompression::zip},
                                                  {"zips", ExrCompression::zips},
                                                  {"piz", ExrCompression::piz},
                                                  {"dwaa", ExrCompression::dwaa},
                                                  {"none", ExrCompression::none}}};

void write_picture(const RenderResult& picture, const std::string& path,
                   const std::vector<std::string>& half, const std::string& compression,
                   bool multipart) {
  const ExrFormat format{value_of("compression", compression, kCompressions), multipart, half};
  const nb::gil_scoped_release released;
  write_exr(picture.film, path, format);
}

void write_preview(const RenderResult& picture, const std::string& path, const std::string& layer,
                   std::optional<float> exposure, bool sky,
                   const std::optional<std::array<float, 3>>& color) {
  using Background = PngOptions::Background;
  PngOptions options{exposure, sky ? Background::sky : Background::none, {}};
  if (color) {
    options.background = Background::color;
    options.color = V3f((*color)[0], (*color)[1], (*color)[2]);
  }
  const nb::gil_scoped_release released;
  write_png(picture.film, path, layer, options);
}

void write_deep(const RenderResult& picture, const std::string& path) {
  if (picture.film.deep.first.empty())
    throw Error(ErrorKind::usage, "the picture has no deep data: render it with deep=True");
  const nb::gil_scoped_release released;
  write_deep_exr(picture.film, path);
}

}  // namespace

void bind_pictures(nb::module_& module) {
  nb::class_<RenderResult>(module, "Picture")
      .def("pixels", pixels, nb::arg("channel"))
      .def_prop_ro("channels", channels)
      .def_prop_ro("metadata", metadata)
      .def_prop_ro("notes", [](const RenderResult& r) { return r.statistics.notes; })
      .def_prop_ro("rmse", [](const RenderResult& r) { return r.statistics.rmse; })
      .def_prop_ro("bias", [](const RenderResult& r) { return bias_fields(r.statistics.bias); })
      .def_prop_ro("footprint", [](const RenderResult& r) { return r.statistics.footprint; })
      .def_prop_ro("largest_irradiance",
                   [](const RenderResult& r) { return r.statistics.largest_irradiance; })
      .def_prop_ro("seconds", [](const RenderResult& r) { return r.statistics.seconds.total; })
      .def("write_exr", write_picture, nb::arg("path"), nb::arg("half"), nb::arg("compression"),
           nb::arg("multipart"))
      .def("write_png", write_preview, nb::arg("path"), nb::arg("layer"),
           nb::arg("exposure").none(), nb::arg("sky"), nb::arg("color").none())
      .def("write_deep_exr", write_deep, nb::arg("path"));
  module.def("render", render_picture, nb::arg("scene"), nb::arg("options"),
             nb::arg("progress").none());
}

}  // namespace dapple::python
