// Checks of keys and values: see light_fields.hpp.
#include "scene/lights/light_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dapple/error.hpp"
#include "scene/check/numeric_range.hpp"

namespace dapple {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxMessage = 300;  // bytes; messages quote keys and text of the file
constexpr std::size_t kMaxName = 200;
constexpr std::array<std::string_view, 5> kKeysOfAll = {"name", "type", "group", "enabled",
                                                        "exposure"};

std::string element(const char* key, int index) { return fmt::format("{}[{}]", key, index); }

/// In floats, as values are: a limit of 0.0001 allows what a file calls 0.0001.
bool is_within(float value, double low, double high) {
  return value >= static_cast<float>(low) && value <= static_cast<float>(high);
}

}  // namespace

void fail_lights(std::string_view where, std::string_view what) {
  std::string message = fmt::format("{}: {}", where, what.substr(0, kMaxMessage));
  // Names and keys come from the file and may hold line breaks; a message is one line.
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  throw Error(ErrorKind::input, message);
}

LightFields::LightFields(const std::string& path, std::size_t number, const Json& fields)
    : where_(fmt::format("{}: light {}", path, number)), fields_(fields) {
  if (!fields_.is_object()) fail_lights(where_, "is not an object");
  if (const auto name = fields_.find("name"); name != fields_.end() && name->is_string()) {
    where_ += fmt::format(" (\"{}\")", name->get<std::string>().substr(0, kMaxName));
  }
}

bool LightFields::has(const char* key) const { return fields_.contains(key); }

void LightFields::fail_at(std::string_view key, std::string_view what) const {
  fail_lights(where_, fmt::format("{} {}", key, what));
}

void LightFields::allow_only(std::initializer_list<std::string_view> keys) const {
  for (const auto& [key, value] : fields_.items()) {
    if (std::find(kKeysOfAll.begin(), kKeysOfAll.end(), key) != kKeysOfAll.end()) continue;
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    fail_at(fmt::format("\"{}\"", key),
            fmt::format("is not known here; known: {}, {}", fmt::join(kKeysOfAll, ", "),
                        fmt::join(keys, ", ")));
  }
}

std::string LightFields::text(const char* key) const {
  const Json& value = get(key);
  if (!value.is_string()) fail_at(key, "must be a string");
  return value.get<std::string>();
}

bool LightFields::flag(const char* key) const {
  const Json& value = get(key);
  if (!value.is_boolean()) fail_at(key, "must be true or false");
  return value.get<bool>();
}

float LightFields::number(const char* key) const { return to_number(get(key), key); }

float LightFields::in_range(const char* key, double low, double high) const {
  const float value = number(key);
  if (!is_within(value, low, high)) {
    fail_at(key, fmt::format("must be from {:g} to {:g}, and is {:g}", low, high, value));
  }
  return value;
}

float LightFields::length(const char* key) const { return require_length(number(key), key); }

V2f LightFields::lengths(const char* key) const {
  const Json& value = array(key, 2);
  V2f result;
  for (int k = 0; k < 2; ++k) {
    result[k] = require_length(to_number(value[k], element(key, k)), element(key, k));
  }
  return result;
}

V3f LightFields::point(const char* key) const {
  const V3f value = numbers(key);
  for (int k = 0; k < 3; ++k) {
    if (is_within(value[k], -kLargestCoordinate, kLargestCoordinate)) continue;
    fail_at(element(key, k), fmt::format("must be within {:g} m", kLargestCoordinate));
  }
  return value;
}

V3f LightFields::direction(const char* key) const {
  const Imath::V3d value(numbers(key));  // in double, a float's square is never 0 or infinite
  if (value.length2() == 0) fail_at(key, "has no direction: it is 0, 0, 0");
  return V3f(value.normalized());
}

V3f LightFields::direction_or_target(const char* key, V3f position) const {
  if (has(key) && has("target")) fail_at(key, "and target are given: leave one out");
  if (!has(key) && !has("target")) fail_at(key, "or target is missing: where the light shines");
  if (has(key)) return direction(key);
  const Imath::V3d way = Imath::V3d(point("target")) - Imath::V3d(position);
  if (way.length2() == 0) fail_at("target", "is the light's position: no direction leads there");
  return V3f(way.normalized());
}

V3f LightFields::colour(const char* key) const {
  if (!get(key).is_number() && !(get(key).is_array() && get(key).size() == 3))
    fail_at(key, "must be a number or an array of 3 numbers");
  const V3f value = get(key).is_number() ? V3f(number(key)) : numbers(key);
  for (int k = 0; k < 3; ++k) {
    if (value[k] < 0) fail_at(key, fmt::format("must not be negative, and is {}", value[k]));
    if (!is_within(value[k], 0, kLargestRadiance))
      fail_at(key, fmt::format("is above {:g}", kLargestRadiance));
  }
  return value;
}

const Json& LightFields::get(const char* key) const {
  const auto found = fields_.find(key);
  if (found == fields_.end()) fail_at(key, "is missing");
  return *found;
}

const Json& LightFields::array(const char* key, std::size_t count) const {
  const Json& value = get(key);
  if (!value.is_array() || value.size() != count) {
    fail_at(key, fmt::format("must be an array of {} numbers", count));
  }
  return value;
}

V3f LightFields::numbers(const char* key) const {
  const Json& value = array(key, 3);
  V3f result;
  for (int k = 0; k < 3; ++k) result[k] = to_number(value[k], element(key, k));
  return result;
}

float LightFields::to_number(const Json& value, std::string_view key) const {
  if (!value.is_number()) fail_at(key, "must be a number");
  const auto number = static_cast<float>(value.get<double>());
  if (!std::isfinite(number)) fail_at(key, "is too large");
  return number;
}

float LightFields::require_length(float value, std::string_view key) const {
  if (!(value > 0)) fail_at(key, fmt::format("must be positive, and is {}", value));
  if (is_within(value, kSmallestLength, kLargestCoordinate)) return value;
  fail_at(key, fmt::format("must be from {:g} to {:g} m, and is {:g}", kSmallestLength,
                           kLargestCoordinate, value));
}

}  // namespace dapple
