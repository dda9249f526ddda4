// The walk that checks a document against the rules: see schema.hpp.
#include "scene/gltf/schema.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>

#include "scene/gltf/message.hpp"
#include "scene/gltf/schema_rules.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

class Checker {
 public:
  explicit Checker(const std::string& file) : file_(file) {}

  void check_object(Json& object, Rules rules, const std::string& where) const {
    for (const Rule& rule : rules) {
      const auto found = object.find(rule.key);
      if (found != object.end()) {
        check_value(*found, rule, where);
      } else if (rule.required) {
        fail(file_, "{}{} is missing", prefix(where), rule.key);
      }
    }
  }

 private:
  static std::string prefix(const std::string& where) { return where.empty() ? "" : where + ": "; }

  [[noreturn]] void refuse(const Rule& rule, const std::string& where,
                           std::string_view expected) const {
    fail(file_, "{}{} is not {}", prefix(where), rule.key, expected);
  }

  void check_integer(Json& value, const Rule& rule, const std::string& where, double limit) const {
    const bool is_number = value.is_number();
    const double number = is_number ? value.get<double>() : -1.0;
    if (!(number >= 0 && number < limit) || number != std::floor(number)) {
      refuse(rule, where, fmt::format("an integer from 0 to {:.0f}", limit - 1));
    }
    if (value.is_number_float()) value = static_cast<std::uint64_t>(number);
  }

  void check_index(Json& value, const Rule& rule, const std::string& where) const {
    check_integer(value, rule, where, 0x1p31);
  }

  /// Turns integers into floating point as well: tinygltf keeps those in extensions as ints.
  void check_number(Json& value, const Rule& rule, const std::string& where) const {
    const bool fits = value.is_number() &&
                      std::abs(value.get<double>()) <= double{std::numeric_limits<float>::max()};
    if (!fits) refuse(rule, where, "a number that a float can hold");
    value = value.get<double>();
  }

  void check_numbers(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array of numbers");
    if (rule.length != 0 && value.size() != rule.length) {
      fail(file_, "{}{} has {} numbers, not {}", prefix(where), rule.key, value.size(),
           rule.length);
    }
    for (Json& item : value) check_number(item, rule, where);
  }

  void check_component_type(Json& value, const Rule& rule, const std::string& where) const {
    check_index(value, rule, where);
    const int code = value.get<int>();
    if (code < 5120 || code > 5126 || code == 5124) {
      fail(file_, "{}{} is {}, not 5120 to 5123, 5125 or 5126", prefix(where), rule.key, code);
    }
  }

  void check_word(const Json& value, const Rule& rule, const std::string& where,
                  std::initializer_list<std::string_view> words) const {
    const bool known =
        value.is_string() &&
        std::find(words.begin(), words.end(), value.get_ref<const std::string&>()) != words.end();
    if (!known) refuse(rule, where, fmt::format("one of {}", fmt::join(words, ", ")));
  }

  void check_objects(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array");
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string item =
          fmt::format("{}{}{} {}", where, where.empty() ? "" : " ", rule.noun, i);
      if (!value[i].is_object()) fail(file_, "{} is not an object", item);
      check_object(value[i], rule.children, item);
    }
  }

  void check_value(Json& value, const Rule& rule, const std::string& where) const {
    switch (rule.kind) {
      case Kind::index:
        return check_index(value, rule, where);
      case Kind::count:
        return check_integer(value, rule, where, 0x1p53);
      case Kind::stride:
        check_integer(value, rule, where, 253);
        if (value.get<int>() < 4 || value.get<int>() % 4 != 0) {
          refuse(rule, where, "a multiple of 4 from 4 to 252");
        }
        return;
      case Kind::number:
        return check_number(value, rule, where);
      case Kind::numbers:
        return check_numbers(value, rule, where);
      case Kind::indices:
        if (!value.is_array()) refuse(rule, where, "an array of integers");
        for (Json& item : value) check_index(item, rule, where);
        return;
      case Kind::index_map:
        if (!value.is_object()) refuse(rule, where, "an object");
        for (Json& item : value) check_index(item, rule, where);
        return;
      case Kind::text:
        if (!value.is_string()) refuse(rule, where, "a string");
        return;
      case Kind::texts:
        if (!value.is_array()) refuse(rule, where, "an array of strings");
        for (const Json& item : value) {
          if (!item.is_string()) refuse(rule, where, "an array of strings");
        }
        return;
      case Kind::component_type:
        return check_component_type(value, rule, where);
      case Kind::element_type:
        return check_word(value, rule, where,
                          {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"});
      case Kind::camera_type:
        return check_word(value, rule, where, {"perspective", "orthographic"});
      case Kind::boolean:
        if (!value.is_boolean()) refuse(rule, where, "true or false");
        return;
      case Kind::object:
        if (!value.is_object()) refuse(rule, where, "an object");
        return check_object(value, rule.children,
                            fmt::format("{}{}{}", where, where.empty() ? "" : " ", rule.key));
      case Kind::objects:
        return check_objects(value, rule, where);
    }
  }

  const std::string& file_;
};

}  // namespace

void check_schema(Json& root, const std::string& file) {
  if (!root.is_object()) fail(file, "is not a glTF document (its JSON is no object)");
  Checker(file).check_object(root, document_rules(), "");
}

}  // namespace dapple::gltf
