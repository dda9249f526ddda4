// The keys and values of one light of a lights file. In: a JSON object; out: numbers, directions
// and colours in range, or an Error that names the file, the light and the key.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "dapple/scene.hpp"

namespace dapple {

/// Throws Error input: `where`, then `what`, in one line.
[[noreturn]] void fail_lights(std::string_view where, std::string_view what);

class LightFields {
 public:
  /// `number` counts the file's lights from 1. `fields` must outlive this object.
  LightFields(const std::string& path, std::size_t number, const nlohmann::json& fields);

  [[nodiscard]] bool has(const char* key) const;
  [[noreturn]] void fail_at(std::string_view key, std::string_view what) const;

  /// Refuses keys that are neither in `keys` nor among those that every light has.
  void allow_only(std::initializer_list<std::string_view> keys) const;

  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] bool flag(const char* key) const;
  [[nodiscard]] float number(const char* key) const;
  [[nodiscard]] float in_range(const char* key, double low, double high) const;

  /// A length in metres, from kSmallestLength to kLargestCoordinate.
  [[nodiscard]] float length(const char* key) const;
  [[nodiscard]] V2f lengths(const char* key) const;

  [[nodiscard]] V3f point(const char* key) const;
  [[nodiscard]] V3f direction(const char* key) const;  ///< unit

  /// The direction of `key`, or that from `position` to the point "target".
  [[nodiscard]] V3f direction_or_target(const char* key, V3f position) const;

  /// Three numbers, or one number for a grey. At least 0, in W/(sr m^2) or W/m^2.
  [[nodiscard]] V3f colour(const char* key) const;

 private:
  [[nodiscard]] const nlohmann::json& get(const char* key) const;
  [[nodiscard]] const nlohmann::json& array(const char* key, std::size_t count) const;
  [[nodiscard]] V3f numbers(const char* key) const;
  [[nodiscard]] float to_number(const nlohmann::json& value, std::string_view key) const;
  [[nodiscard]] float require_length(float value, std::string_view key) const;

  std::string where_;
  const nlohmann::json& fields_;
};

}  // namespace dapple
