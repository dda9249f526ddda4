#include "render/partial/picture_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "camera/camera_splitting.hpp"
#include "dapple/error.hpp"

namespace dapple {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxLights = 1u << 20;

json matrix_json(const M44f& m) { return std::vector<float>(&m[0][0], &m[0][0] + 16); }

M44f matrix_of(const json& numbers) {
  const auto values = numbers.get<std::array<float, 16>>();
  M44f m;
  std::copy(values.begin(), values.end(), &m[0][0]);
  return m;
}

json options_json(const RenderOptions& o) {
  json out = {{"ao", o.ao},
              {"light", o.light},
              {"albedo", o.albedo},
              {"beauty", o.beauty},
              {"back", o.back},
              {"visits", o.visits},
              {"motion", o.motion},
              {"matte_objects", o.cryptomattes.objects},
              {"matte_materials", o.cryptomattes.materials},
              {"ao_rays", o.ao_rays},
              {"light_rays", o.light_rays},
              {"camera_splitting", splitting_factor(o)}};
  if (o.ambient) out["ambient"] = *o.ambient;
  return out;
}

RenderOptions options_of(const json& about) {
  RenderOptions o;
  o.ao = about.at("ao").get<bool>();
  o.light = about.at("light").get<bool>();
  o.albedo = about.at("albedo").get<bool>();
  o.beauty = about.at("beauty").get<bool>();
  o.back = about.at("back").get<bool>();
  o.visits = about.at("visits").get<bool>();
  o.motion = about.at("motion").get<bool>();
  o.cryptomattes = {about.at("matte_objects").get<bool>(), about.at("matte_materials").get<bool>()};
  o.ao_rays = about.at("ao_rays").get<int>();
  o.light_rays = about.at("light_rays").get<int>();
  o.camera_splitting = about.at("camera_splitting").get<int>();
  if (about.contains("ambient")) o.ambient = about.at("ambient").get<float>();
  return o;
}

json lights_json(const std::vector<Light>& lights) {
  json list = json::array();
  for (const Light& light : lights) {
    const V3f& radiance = light.radiance;
    list.push_back({{"name", light.name},
                    {"group", light.group},
                    {"kind", static_cast<int>(light.kind)},
                    {"radiance", {radiance.x, radiance.y, radiance.z}}});
  }
  return list;
}

std::vector<Light> lights_of(const json& list) {
  std::vector<Light> lights;
  for (const json& one : list) {
    Light light;
    light.name = one.at("name").get<std::string>();
    light.group = one.at("group").get<std::string>();
    light.kind = static_cast<LightKind>(std::min(one.at("kind").get<unsigned>(), 255u));
    const auto radiance = one.at("radiance").get<std::array<float, 3>>();
    light.radiance = {radiance[0], radiance[1], radiance[2]};
    lights.push_back(std::move(light));
  }
  return lights;
}

json metadata_json(const FilmMetadata& m) {
  return {{"world_to_camera", matrix_json(m.world_to_camera)},
          {"world_to_ndc", matrix_json(m.world_to_ndc)},
          {"samples", m.samples},
          {"seed", m.seed},
          {"scene", m.scene},
          {"device", m.device},
          {"version", m.version},
          {"settings", m.settings}};
}

FilmMetadata metadata_of(const json& about) {
  FilmMetadata m;
  m.world_to_camera = matrix_of(about.at("world_to_camera"));
  m.world_to_ndc = matrix_of(about.at("world_to_ndc"));
  m.samples = about.at("samples").get<int>();
  m.seed = about.at("seed").get<std::uint32_t>();
  m.scene = about.at("scene").get<std::string>();
  m.device = about.at("device").get<std::string>();
  m.version = about.at("version").get<std::string>();
  m.settings = about.at("settings").get<std::vector<std::pair<std::string, std::string>>>();
  return m;
}

void require(bool condition, const char* what) {
  if (!condition) throw Error(ErrorKind::failed, fmt::format("damaged: its {}", what));
}

bool is_from(int value, int low, int high) { return value >= low && value <= high; }

bool is_in_picture(const PixelRect& crop, int width, int height) {
  return crop.x0 >= 0 && crop.y0 >= 0 && crop.x0 <= crop.x1 && crop.y0 <= crop.y1 &&
         crop.x1 < width && crop.y1 < height;
}

/// Powers of two, as scale_for() chooses them.
bool is_scale(float scale) { return std::isfinite(scale) && scale > 0; }

void check(const PictureRecord& record) {
  const RenderOptions& o = record.options;
  require(is_from(record.width, 1, 65535) && is_from(record.height, 1, 65535), "size");
  require(is_in_picture(record.crop, record.width, record.height), "crop");
  require(is_from(o.ao_rays, 1, 4096) && is_from(o.light_rays, 1, 4096), "rays");
  require(o.camera_splitting == 1 || o.camera_splitting == 2 || o.camera_splitting == 4,
          "camera splitting");
  require(!o.ambient || (*o.ambient >= 0 && std::isfinite(*o.ambient)), "ambient");
  require(is_scale(record.scales.position) && is_scale(record.scales.depth) &&
              record.scales.lights.size() == record.lights.size() &&
              std::all_of(record.scales.lights.begin(), record.scales.lights.end(), is_scale),
          "scales");
  require(is_from(record.metadata.samples, 0, 1 << 20), "number of samples");
  require(record.lights.size() <= kMaxLights, "lights");
  for (const Light& light : record.lights)
    for (int channel = 0; channel < 3; ++channel)
      require(light.radiance[channel] >= 0 && std::isfinite(light.radiance[channel]), "lights");
}

}  // namespace

PictureRecord record_of(const View& view, const RenderOptions& options, const FilmLayout& layout,
                        const std::vector<Light>& lights, MatteNames names, FilmMetadata metadata) {
  PictureRecord record{view.width,
                       view.height,
                       view.crop,
                       options,
                       lights,
                       layout.normals != 0,
                       {layout.position_scale, layout.depth_scale, {}},
                       std::move(names),
                       std::move(metadata)};
  for (Light& light : record.lights) light.environment.reset();
  for (const LightPlaneRange& light : layout.lights) record.scales.lights.push_back(light.scale);
  return record;
}

void set_ambient(FilmMetadata& metadata, double ambient) {
  for (auto& [name, value] : metadata.settings)
    if (name == kAmbient) value = fmt::format("{}", static_cast<float>(ambient));
}

json to_json(const PictureRecord& record) {
  const PixelRect& crop = record.crop;
  return {{"size", {record.width, record.height}},
          {"crop", {crop.x0, crop.y0, crop.x1, crop.y1}},
          {"options", options_json(record.options)},
          {"lights", lights_json(record.lights)},
          {"has_normals", record.has_normals},
          {"scales", {record.scales.position, record.scales.depth}},
          {"light_scales", record.scales.lights},
          {"objects", record.names.objects},
          {"materials", record.names.materials},
          {"metadata", metadata_json(record.metadata)}};
}

PictureRecord picture_record(const json& about) {
  const auto size = about.at("size").get<std::array<int, 2>>();
  const auto crop = about.at("crop").get<std::array<int, 4>>();
  const auto scales = about.at("scales").get<std::array<float, 2>>();
  PictureRecord record{size[0],
                       size[1],
                       {crop[0], crop[1], crop[2], crop[3]},
                       options_of(about.at("options")),
                       lights_of(about.at("lights")),
                       about.at("has_normals").get<bool>(),
                       {scales[0], scales[1], about.at("light_scales").get<std::vector<float>>()},
                       {about.at("objects").get<std::vector<std::string>>(),
                        about.at("materials").get<std::vector<std::string>>()},
                       metadata_of(about.at("metadata"))};
  check(record);
  return record;
}

}  // namespace dapple
