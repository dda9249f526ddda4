// Reads a JSON file of lights. In: {"lights": [{"type": "rect", ...}, ...]}; out: Lights.
// An unknown key is an error, because a misspelt key would silently leave a default value.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"
#include "scene/json_structure.hpp"
#include "scene/numeric_range.hpp"
#include "scene/rect_axes.hpp"
#include "scene/side_file.hpp"

namespace dapple {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t kMaxFileBytes = 16u << 20;
constexpr std::size_t kMaxDepth = 16;     // the format needs 4
constexpr double kSunDegrees = 0.533;     // angular diameter of the real sun
constexpr std::size_t kMaxMessage = 300;  // bytes; messages quote keys and text of the file
constexpr std::size_t kMaxName = 200;
constexpr std::size_t kMaxLights = 4096;

[[noreturn]] void fail(std::string_view where, std::string_view what) {
  std::string message = fmt::format("{}: {}", where, what.substr(0, kMaxMessage));
  // Names and keys come from the file and may hold line breaks; a message is one line.
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  throw Error(ErrorKind::input, message);
}

std::string read_text(const std::string& path) {
  const auto bytes = read_side_file(path, "lights file", kMaxFileBytes);
  return {bytes.begin(), bytes.end()};
}

Json parse_json(const std::string& path, const std::string& text) {
  const std::string defect = json_structure_defect(text, kMaxDepth);
  if (!defect.empty()) fail(path, defect);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    // Removes the beginning "[json.exception.parse_error.101] ", which says nothing to a user.
    std::string_view message = error.what();
    message.remove_prefix(std::min(message.size(), message.find("] ") + 2));
    fail(path, message);
  }
}

// The keys and values of one light. Error messages name the file and the light.
class LightFields {
 public:
  LightFields(const std::string& path, std::size_t number, const Json& fields)
      : where_(fmt::format("{}: light {}", path, number)), fields_(fields) {
    if (!fields_.is_object()) fail(where_, "is not an object");
    if (const auto name = fields_.find("name"); name != fields_.end() && name->is_string()) {
      where_ += fmt::format(" (\"{}\")", name->get<std::string>().substr(0, kMaxName));
    }
  }

  [[nodiscard]] bool has(const char* key) const { return fields_.contains(key); }

  [[noreturn]] void fail_at(std::string_view key, std::string_view what) const {
    fail(where_, fmt::format("{} {}", key, what));
  }

  void allow_only(std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, value] : fields_.items()) {
      if (key == "name" || key == "type") continue;
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      std::string known = "name, type";
      for (const std::string_view other : keys) known.append(", ").append(other);
      fail_at(fmt::format("\"{}\"", key), "is not known here; known: " + known);
    }
  }

  [[nodiscard]] std::string text(const char* key) const {
    const Json& value = get(key);
    if (!value.is_string()) fail_at(key, "must be a string");
    return value.get<std::string>();
  }

  [[nodiscard]] float number(const char* key) const { return to_number(get(key), key); }

  /// A length in metres, from kSmallestLength to kLargestCoordinate.
  [[nodiscard]] float length(const char* key) const { return require_length(number(key), key); }

  [[nodiscard]] float in_range(const char* key, double low, double high) const {
    const float value = number(key);
    if (!(value >= low && value <= high)) {
      fail_at(key, fmt::format("must be from {:g} to {:g}, and is {:g}", low, high, value));
    }
    return value;
  }

  [[nodiscard]] V3f numbers(const char* key) const {
    const Json& value = array(key, 3);
    V3f result;
    for (int k = 0; k < 3; ++k) result[k] = to_number(value[k], element(key, k));
    return result;
  }

  [[nodiscard]] V3f point(const char* key) const {
    const V3f value = numbers(key);
    for (int k = 0; k < 3; ++k) {
      if (std::abs(value[k]) <= kLargestCoordinate) continue;
      fail_at(element(key, k), fmt::format("must be within {:g} m", kLargestCoordinate));
    }
    return value;
  }

  [[nodiscard]] V3f direction(const char* key) const {
    const Imath::V3d value(numbers(key));  // in double, a float's square is never 0 or infinite
    if (value.length2() == 0) fail_at(key, "has no direction: it is 0, 0, 0");
    return V3f(value.normalized());
  }

  [[nodiscard]] V2f size(const char* key) const {
    const Json& value = array(key, 2);
    V2f result;
    for (int k = 0; k < 2; ++k) {
      result[k] = require_length(to_number(value[k], element(key, k)), element(key, k));
    }
    return result;
  }

  // Three numbers, or one number for a grey. At least 0, in W/(sr m^2) or W/m^2.
  [[nodiscard]] V3f colour(const char* key) const {
    const V3f value = get(key).is_number() ? V3f(number(key)) : numbers(key);
    for (int k = 0; k < 3; ++k) {
      if (value[k] < 0) fail_at(key, fmt::format("must not be negative, and is {}", value[k]));
      if (value[k] > kLargestRadiance) fail_at(key, fmt::format("is above {:g}", kLargestRadiance));
    }
    return value;
  }

 private:
  [[nodiscard]] const Json& get(const char* key) const {
    const auto found = fields_.find(key);
    if (found == fields_.end()) fail_at(key, "is missing");
    return *found;
  }

  [[nodiscard]] const Json& array(const char* key, std::size_t count) const {
    const Json& value = get(key);
    if (!value.is_array() || value.size() != count) {
      fail_at(key, fmt::format("must be an array of {} numbers", count));
    }
    return value;
  }

  static std::string element(const char* key, int index) {
    return fmt::format("{}[{}]", key, index);
  }

  [[nodiscard]] float to_number(const Json& value, std::string_view key) const {
    if (!value.is_number()) fail_at(key, "must be a number");
    const auto number = static_cast<float>(value.get<double>());
    if (!std::isfinite(number)) fail_at(key, "is too large");
    return number;
  }

  [[nodiscard]] float require_length(float value, std::string_view key) const {
    if (!(value > 0)) fail_at(key, fmt::format("must be positive, and is {}", value));
    if (value >= kSmallestLength && value <= kLargestCoordinate) return value;
    fail_at(key, fmt::format("must be from {:g} to {:g} m, and is {:g}", kSmallestLength,
                             kLargestCoordinate, value));
  }

  std::string where_;
  const Json& fields_;
};

Light read_rect(const LightFields& fields) {
  fields.allow_only({"position", "normal", "size", "radiance"});
  Light light;
  light.kind = LightKind::rect;
  light.position = fields.point("position");
  light.direction = fields.direction("normal");
  const V2f size = fields.size("size");
  const RectAxes axes = rect_axes(light.direction);
  light.edge_u = axes.u * size.x;
  light.edge_v = axes.v * size.y;
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

Light read_sun(const LightFields& fields) {
  fields.allow_only({"direction", "angle_degrees", "radiance", "irradiance"});
  Light light;
  light.kind = LightKind::sun;
  light.direction = fields.direction("direction");
  const double degrees =
      fields.has("angle_degrees") ? fields.in_range("angle_degrees", 1e-4, 179.999) : kSunDegrees;
  const double angular_radius = degrees * std::numbers::pi / 360;
  light.angular_radius = static_cast<float>(angular_radius);
  if (fields.has("radiance") == fields.has("irradiance")) {
    fields.fail_at("radiance", "or irradiance must be given, and not both");
  }
  if (fields.has("radiance")) {
    light.radiance = fields.colour("radiance");
    return light;
  }
  // The irradiance of a surface that faces a disk of constant radiance L is L * pi * sin^2(angular
  // radius).
  const double sine = std::sin(angular_radius);
  light.radiance =
      fields.colour("irradiance") * static_cast<float>(1 / (std::numbers::pi * sine * sine));
  if (!std::isfinite(light.radiance.length2())) {
    fields.fail_at("irradiance", "is too large for so small an angle_degrees");
  }
  return light;
}

Light read_dome(const LightFields& fields, const std::filesystem::path& folder) {
  fields.allow_only({"image", "radiance", "rotation_degrees"});
  Light light;
  light.kind = LightKind::dome;
  if (fields.has("radiance")) light.radiance = fields.colour("radiance");
  if (fields.has("image"))
    light.environment = load_environment((folder / fields.text("image")).string());
  if (fields.has("rotation_degrees")) {
    light.rotation = static_cast<float>(std::remainder(fields.number("rotation_degrees"), 360.0) *
                                        std::numbers::pi / 180);
  }
  return light;
}

Light read_light(const LightFields& fields, std::size_t number,
                 const std::filesystem::path& folder) {
  const std::string type = fields.text("type");
  Light light;
  if (type == "rect") {
    light = read_rect(fields);
  } else if (type == "sphere") {
    light = read_sphere(fields);
  } else if (type == "sun") {
    light = read_sun(fields);
  } else if (type == "dome") {
    light = read_dome(fields, folder);
  } else {
    fields.fail_at("type", fmt::format("\"{}\" is not rect, sphere, sun or dome", type));
  }
  light.name = fields.has("name") ? fields.text("name") : fmt::format("{}_{}", type, number);
  return light;
}

}  // namespace

std::vector<Light> load_lights(const std::string& path) {
  const Json file = parse_json(path, read_text(path));
  if (!file.is_object() || !file.contains("lights") || !file["lights"].is_array()) {
    fail(path, "must be an object with an array \"lights\"");
  }
  for (const auto& [key, value] : file.items()) {
    if (key != "lights") fail(path, fmt::format("\"{}\" is not known here; known: lights", key));
  }
  if (file["lights"].size() > kMaxLights) {
    fail(path, fmt::format("has {} lights; there may be {}", file["lights"].size(), kMaxLights));
  }
  std::vector<Light> lights;
  for (const Json& fields : file["lights"]) {
    const std::size_t number = lights.size() + 1;
    lights.push_back(read_light(LightFields(path, number, fields), number,
                                std::filesystem::path(path).parent_path()));
  }
  return lights;
}

}  // namespace dapple
