// Reads a JSON file of lights. In: {"lights": [{"type": "rect", ...}, ...]}; out: Lights.
// An unknown key is an error, because a misspelt key would silently leave a default value.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/check/numeric_range.hpp"
#include "scene/json_structure.hpp"
#include "scene/lights/light_fields.hpp"
#include "scene/lights/rect_axes.hpp"
#include "scene/regular_file.hpp"

namespace dapple {
namespace {

using Json = nlohmann::json;

constexpr FileKind kLightsFile{"lights file", 16u << 20};
constexpr std::size_t kMaxDepth = 16;  // the format needs 4
constexpr std::size_t kMaxLights = 4096;
constexpr double kSunDegrees = 0.533;  // angular diameter of the real sun
constexpr double kMaxStops = 100;
constexpr double kOuterDegrees = 45;        // of a spot's cone, as in KHR_lights_punctual
constexpr double kLeastOuterDegrees = 0.2;  // cosines of less are too coarse as floats

std::string read_text(const std::string& path) {
  const auto bytes = read_regular_file(path, path, kLightsFile);
  return {bytes.begin(), bytes.end()};
}

Json parse_json(const std::string& path, const std::string& text) {
  const std::string defect = json_structure_defect(text, kMaxDepth);
  if (!defect.empty()) fail_lights(path, defect);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    // Removes the beginning "[json.exception.parse_error.101] ", which says nothing to a user.
    std::string_view message = error.what();
    message.remove_prefix(std::min(message.size(), message.find("] ") + 2));
    fail_lights(path, message);
  }
}

Light read_rect(const LightFields& fields) {
  fields.allow_only({"position", "normal", "target", "size", "radiance"});
  Light light;
  light.kind = LightKind::rect;
  light.position = fields.point("position");
  light.direction = fields.direction_or_target("normal", light.position);
  const V2f size = fields.lengths("size");
  const RectAxes axes = rect_axes(light.direction);
  light.edge_u = axes.u * size.x;
  light.edge_v = axes.v * size.y;
  light.radiance = fields.colour("radiance");
  return light;
}

Light read_disk(const LightFields& fields) {
  fields.allow_only({"position", "normal", "target", "radius", "radiance"});
  Light light;
  light.kind = LightKind::disk;
  light.position = fields.point("position");
  light.direction = fields.direction_or_target("normal", light.position);
  light.radius = fields.length("radius");
  light.radiance = fields.colour("radiance");
  return light;
}

Light read_sphere(const LightFields& fields) {
  fields.allow_only({"position", "radius", "radiance"});
  Light light;
  light.kind = LightKind::sphere;
  light.position = fields.point("position");
  light.radius = fields.length("radius");
  light.radiance = fields.colour("radiance");
  return light;
}

float cosine_of_degrees(double degrees) {
  return static_cast<float>(std::max(0.0, std::cos(degrees * std::numbers::pi / 180)));
}

Light read_spot(const LightFields& fields) {
  fields.allow_only(
      {"position", "direction", "target", "radius", "inner_degrees", "outer_degrees", "radiance"});
  Light light;
  light.kind = LightKind::sphere;
  light.position = fields.point("position");
  light.direction = fields.direction_or_target("direction", light.position);
  light.radius = fields.length("radius");
  const double outer = fields.has("outer_degrees")
                           ? fields.in_range("outer_degrees", kLeastOuterDegrees, 90)
                           : kOuterDegrees;
  const double inner =
      fields.has("inner_degrees") ? fields.in_range("inner_degrees", 0, outer) : 0.0;
  light.cos_outer = cosine_of_degrees(outer);
  light.cos_inner = cosine_of_degrees(inner);
  light.radiance = fields.colour("radiance");
  return light;
}

Light read_sun(const LightFields& fields) {
  fields.allow_only({"direction", "angle_degrees", "radiance", "irradiance"});
  Light light;
  light.kind = LightKind::sun;
  light.direction = fields.direction("direction");
  const double degrees =
      fields.has("angle_degrees") ? fields.in_range("angle_degrees", 1e-4, 179.999) : kSunDegrees;
  const double angular_radius = degrees * std::numbers::pi / 360;
  light.angular_radius = static_cast<float>(angular_radius);
  if (fields.has("radiance") && fields.has("irradiance"))
    fields.fail_at("radiance", "and irradiance are given: leave one out");
  if (!fields.has("radiance") && !fields.has("irradiance"))
    fields.fail_at("radiance", "or irradiance is missing: how bright the sun is");
  if (fields.has("radiance")) {
    light.radiance = fields.colour("radiance");
    return light;
  }
  // The irradiance of a surface that faces a disk of constant radiance L is L * pi * sin^2(angular
  // radius).
  const double sine = std::sin(angular_radius);
  light.radiance =
      fields.colour("irradiance") * static_cast<float>(1 / (std::numbers::pi * sine * sine));
  const V3f& radiance = light.radiance;
  if (!(std::max({radiance.x, radiance.y, radiance.z}) <= kLargestRadiance)) {
    fields.fail_at("irradiance", "is too large for so small an angle_degrees");
  }
  return light;
}

std::shared_ptr<const Environment> read_image(const LightFields& fields,
                                              const std::filesystem::path& folder) {
  const std::string name = fields.text("image");
  if (name.empty()) fields.fail_at("image", "must not be empty");
  try {
    return load_environment((folder / name).string());
  } catch (const Error& error) {
    fields.fail_at("image", error.what());
  }
}

Light read_dome(const LightFields& fields, const std::filesystem::path& folder) {
  fields.allow_only({"image", "radiance", "rotation_degrees"});
  Light light;
  light.kind = LightKind::dome;
  if (fields.has("radiance")) light.radiance = fields.colour("radiance");
  if (fields.has("image")) light.environment = read_image(fields, folder);
  if (fields.has("rotation_degrees")) {
    light.rotation = static_cast<float>(std::remainder(fields.number("rotation_degrees"), 360.0) *
                                        std::numbers::pi / 180);
  }
  return light;
}

Light read_kind(const LightFields& fields, const std::string& type,
                const std::filesystem::path& folder) {
  if (type == "rect") return read_rect(fields);
  if (type == "disk") return read_disk(fields);
  if (type == "sphere") return read_sphere(fields);
  if (type == "spot") return read_spot(fields);
  if (type == "sun") return read_sun(fields);
  if (type == "dome") return read_dome(fields, folder);
  fields.fail_at("type", fmt::format("\"{}\" is not rect, disk, sphere, spot, sun or dome", type));
}

/// Multiplies the radiance by 2^exposure.
void expose(const LightFields& fields, Light& light) {
  if (!fields.has("exposure")) return;
  light.radiance *= std::exp2(fields.in_range("exposure", -kMaxStops, kMaxStops));
  for (int k = 0; k < 3; ++k) {
    if (light.radiance[k] <= kLargestRadiance) continue;
    fields.fail_at("exposure", fmt::format("makes a radiance above {:g}", kLargestRadiance));
  }
}

Light read_light(const LightFields& fields, std::size_t number,
                 const std::filesystem::path& folder) {
  const std::string type = fields.text("type");
  Light light = read_kind(fields, type, folder);
  expose(fields, light);
  light.name = fields.has("name") ? fields.text("name") : fmt::format("{}_{}", type, number);
  if (fields.has("group")) light.group = fields.text("group");
  if (fields.has("group") && light.group.empty()) fields.fail_at("group", "must not be empty");
  return light;
}

}  // namespace

std::vector<Light> load_lights(const std::string& path) {
  const Json file = parse_json(path, read_text(path));
  if (!file.is_object() || !file.contains("lights") || !file["lights"].is_array()) {
    fail_lights(path, "must be an object with an array \"lights\"");
  }
  for (const auto& [key, value] : file.items()) {
    if (key == "lights") continue;
    fail_lights(path, fmt::format("\"{}\" is not known here; known: lights", key));
  }
  const Json& entries = file["lights"];
  if (entries.size() > kMaxLights) {
    fail_lights(path, fmt::format("has {} lights; there may be {}", entries.size(), kMaxLights));
  }
  std::vector<Light> lights;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const LightFields fields(path, i + 1, entries[i]);
    Light light = read_light(fields, i + 1, std::filesystem::path(path).parent_path());
    light.sequence = static_cast<int>(i);
    if (!fields.has("enabled") || fields.flag("enabled")) lights.push_back(std::move(light));
  }
  return lights;
}

}  // namespace dapple
