// The option structs of the library as Python classes with the same field names. Names of
// enumerations are those of the command line.
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "bindings.hpp"
#include "dapple/bake.hpp"
#include "dapple/points.hpp"
#include "dapple/render.hpp"
#include "names.hpp"
#include "nanobind/stl/array.h"
#include "nanobind/stl/optional.h"
#include "nanobind/stl/pair.h"
#include "nanobind/stl/string.h"
#include "nanobind/stl/vector.h"

namespace dapple::python {
namespace {

namespace nb = nanobind;

constexpr Names<Estimator, 2> kEstimators{
    {{"exact", Estimator::exact}, {"prefiltered", Estimator::prefiltered}}};
constexpr Names<Packets, 5> kPackets{{{"auto", Packets::automatic},
                                      {"none", Packets::none},
                                      {"pixel", Packets::pixel},
                                      {"point", Packets::point},
                                      {"scalar", Packets::scalar}}};
constexpr Names<Normals, 2> kNormals{
    {{"shading", Normals::shading}, {"geometric", Normals::geometric}}};
constexpr Names<BakeSides, 4> kSides{{{"auto", BakeSides::automatic},
                                      {"front", BakeSides::front},
                                      {"max", BakeSides::max},
                                      {"mean", BakeSides::mean}}};
constexpr Names<BakePlacement, 2> kPlacements{
    {{"together", BakePlacement::together}, {"alone", BakePlacement::alone}}};

/// Adds a property that is the name of the enumeration's value.
template <class Options, class Value, std::size_t N>
void add_choice(nb::class_<Options>& bound, const char* name, Value Options::*member,
                const Names<Value, N>& names) {
  const auto get = [member, &names](const Options& options) -> std::string {
    for (const auto& [text, value] : names)
      if (value == options.*member) return text;
    return "";
  };
  const auto set = [name, member, &names](Options& options, const std::string& chosen) {
    options.*member = value_of(name, chosen, names);
  };
  bound.def_prop_rw(name, get, set);
}

void bind_render_options(nb::module_& module) {
  nb::class_<RenderOptions> bound(module, "RenderOptions");
  bound.def(nb::init<>())
      .def_rw("width", &RenderOptions::width)
      .def_rw("height", &RenderOptions::height)
      .def_rw("spp", &RenderOptions::spp)
      .def_rw("target_error", &RenderOptions::target_error)
      .def_rw("target_rmse", &RenderOptions::target_rmse)
      .def_rw("max_spp", &RenderOptions::max_spp)
      .def_rw("camera_splitting", &RenderOptions::camera_splitting)
      .def_rw("ambient", &RenderOptions::ambient)
      .def_rw("aperture", &RenderOptions::aperture)
      .def_rw("focus_distance", &RenderOptions::focus_distance)
      .def_rw("ao_rays", &RenderOptions::ao_rays)
      .def_rw("light_rays", &RenderOptions::light_rays)
      .def_rw("footprint", &RenderOptions::footprint)
      .def_rw("roulette", &RenderOptions::roulette)
      .def_rw("report_bias", &RenderOptions::report_bias)
      .def_rw("max_bias", &RenderOptions::max_bias)
      .def_rw("ao", &RenderOptions::ao)
      .def_rw("light", &RenderOptions::light)
      .def_rw("albedo", &RenderOptions::albedo)
      .def_rw("beauty", &RenderOptions::beauty)
      .def_rw("back", &RenderOptions::back)
      .def_rw("back_every", &RenderOptions::back_every)
      .def_rw("deep", &RenderOptions::deep)
      .def_rw("visits", &RenderOptions::visits)
      .def_prop_rw(
          "crypto_object", [](const RenderOptions& o) { return o.cryptomattes.objects; },
          [](RenderOptions& o, bool on) { o.cryptomattes.objects = on; })
      .def_prop_rw(
          "crypto_material", [](const RenderOptions& o) { return o.cryptomattes.materials; },
          [](RenderOptions& o, bool on) { o.cryptomattes.materials = on; })
      .def_rw("ao_distance", &RenderOptions::ao_distance)
      .def_rw("ao_falloff", &RenderOptions::ao_falloff)
      .def_rw("camera", &RenderOptions::camera)
      .def_rw("fov_degrees", &RenderOptions::fov_degrees)
      .def_rw("seed", &RenderOptions::seed)
      .def_rw("device", &RenderOptions::device)
      .def_rw("cache", &RenderOptions::cache)
      .def_rw("ground", &RenderOptions::ground)
      .def_rw("ground_height", &RenderOptions::ground_height)
      .def_rw("opacity", &RenderOptions::opacity);
  add_choice(bound, "estimator", &RenderOptions::estimator, kEstimators);
  add_choice(bound, "normals", &RenderOptions::normals, kNormals);
  add_choice(bound, "packets", &RenderOptions::packets, kPackets);
  using Vector = std::array<float, 3>;
  bound.def(
      "set_look",
      [](RenderOptions& options, const Vector& from, const Vector& at, const Vector& up) {
        const auto vector = [](const Vector& v) { return V3f(v[0], v[1], v[2]); };
        options.look = LookAt{vector(from), vector(at), vector(up)};
      },
      nb::arg("position"), nb::arg("at"), nb::arg("up"));
  bound.def(
      "set_crop",
      [](RenderOptions& options, int x0, int y0, int x1, int y1) {
        options.crop = PixelRect{x0, y0, x1, y1};
      },
      nb::arg("x0"), nb::arg("y0"), nb::arg("x1"), nb::arg("y1"));
}

void bind_point_options(nb::module_& module) {
  nb::class_<PointOptions> bound(module, "PointOptions");
  bound.def(nb::init<>())
      .def_rw("ao", &PointOptions::ao)
      .def_rw("sky_view_factor", &PointOptions::sky_view_factor)
      .def_rw("bent", &PointOptions::bent)
      .def_rw("rings", &PointOptions::rings)
      .def_rw("lights", &PointOptions::lights)
      .def_rw("per_sun", &PointOptions::per_sun)
      .def_rw("rays", &PointOptions::rays)
      .def_rw("footprint", &PointOptions::footprint)
      .def_rw("report_bias", &PointOptions::report_bias)
      .def_rw("max_bias", &PointOptions::max_bias)
      .def_rw("distance", &PointOptions::distance)
      .def_rw("falloff", &PointOptions::falloff)
      .def_rw("period_x", &PointOptions::period_x)
      .def_rw("period_z", &PointOptions::period_z)
      .def_rw("seed", &PointOptions::seed)
      .def_rw("opacity", &PointOptions::opacity)
      .def_rw("ground", &PointOptions::ground)
      .def_rw("device", &PointOptions::device)
      .def_rw("cache", &PointOptions::cache);
  add_choice(bound, "estimator", &PointOptions::estimator, kEstimators);
}

void bind_bake_options(nb::module_& module) {
  nb::class_<BakeOptions> bound(module, "BakeOptions");
  bound.def(nb::init<>())
      .def_rw("vertices", &BakeOptions::vertices)
      .def_rw("instances", &BakeOptions::instances)
      .def_rw("texture", &BakeOptions::texture)
      .def_rw("bent", &BakeOptions::bent)
      .def_rw("light", &BakeOptions::light)
      .def_rw("light_rays", &BakeOptions::light_rays)
      .def_rw("target_error", &BakeOptions::target_error)
      .def_rw("rays", &BakeOptions::rays)
      .def_rw("footprint", &BakeOptions::footprint)
      .def_rw("report_bias", &BakeOptions::report_bias)
      .def_rw("max_bias", &BakeOptions::max_bias)
      .def_rw("distance", &BakeOptions::distance)
      .def_rw("falloff", &BakeOptions::falloff)
      .def_rw("at_vertices", &BakeOptions::at_vertices)
      .def_rw("texture_size", &BakeOptions::texture_size)
      .def_rw("margin", &BakeOptions::margin)
      .def_rw("seed", &BakeOptions::seed)
      .def_rw("ground", &BakeOptions::ground)
      .def_rw("opacity", &BakeOptions::opacity)
      .def_rw("device", &BakeOptions::device)
      .def_rw("cache", &BakeOptions::cache);
  add_choice(bound, "estimator", &BakeOptions::estimator, kEstimators);
  add_choice(bound, "normals", &BakeOptions::normals, kNormals);
  add_choice(bound, "sides", &BakeOptions::sides, kSides);
  add_choice(bound, "placement", &BakeOptions::placement, kPlacements);
}

}  // namespace

void bind_options(nb::module_& module) {
  nb::class_<OcclusionOptions> occlusion(module, "OcclusionOptions");
  occlusion.def(nb::init<>())
      .def_rw("rays", &OcclusionOptions::rays)
      .def_rw("footprint", &OcclusionOptions::footprint)
      .def_rw("distance", &OcclusionOptions::distance)
      .def_rw("falloff", &OcclusionOptions::falloff)
      .def_rw("seed", &OcclusionOptions::seed);
  add_choice(occlusion, "estimator", &OcclusionOptions::estimator, kEstimators);
  nb::class_<IrradianceOptions> irradiance(module, "IrradianceOptions");
  irradiance.def(nb::init<>())
      .def_rw("rays", &IrradianceOptions::rays)
      .def_rw("footprint", &IrradianceOptions::footprint)
      .def_rw("seed", &IrradianceOptions::seed);
  add_choice(irradiance, "estimator", &IrradianceOptions::estimator, kEstimators);
  bind_render_options(module);
  bind_point_options(module);
  bind_bake_options(module);
}

}  // namespace dapple::python
