// Visits all objects of a document and checks them against the rules: see schema.hpp.
#include "scene/gltf/document/schema.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "scene/gltf/document/schema_rules.hpp"
#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

using Json = nlohmann::json;

class Checker {
 public:
  explicit Checker(const std::string& file) : file_(file) {}

  void check_object(Json& object, Rules rules, const std::string& where) const {
    check_everywhere(object, where);
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
  static std::string below(const std::string& where, const std::string& what) {
    return where.empty() ? what : where + " " + what;
  }

  [[noreturn]] void refuse(const Rule& rule, const std::string& where,
                           std::string_view expected) const {
    fail(file_, "{}{} is not {}", prefix(where), rule.key, expected);
  }

  /// Checks the properties that every object may have. Removes `extras`, which may have any value
  /// and which nothing reads.
  void check_everywhere(Json& object, const std::string& where) const {
    object.erase("extras");
    const auto name = object.find("name");
    if (name != object.end() && !name->is_string())
      fail(file_, "{}name is not a string", prefix(where));
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) return;
    bool sound = extensions->is_object();
    for (const Json& extension : *extensions) sound = sound && extension.is_object();
    if (!sound) fail(file_, "{}extensions is not an object of objects", prefix(where));
  }

  void check_integer(Json& value, const Rule& rule, const std::string& where, double low,
                     double limit) const {
    const bool is_number = value.is_number();
    const double number = is_number ? value.get<double>() : -1.0;
    if (!(number >= low && number < limit) || number != std::floor(number)) {
      refuse(rule, where, fmt::format("an integer from {:.0f} to {:.0f}", low, limit - 1));
    }
    if (value.is_number_float()) value = static_cast<std::uint64_t>(number);
  }

  void check_index(Json& value, const Rule& rule, const std::string& where) const {
    check_integer(value, rule, where, 0, 0x1p31);
  }

  void check_stride(Json& value, const Rule& rule, const std::string& where) const {
    check_integer(value, rule, where, 0, 253);
    if (value.get<int>() >= 4 && value.get<int>() % 4 == 0) return;
    refuse(rule, where, "a multiple of 4 from 4 to 252");
  }

  /// Also converts integers to floating point, because tinygltf keeps integers in extensions as
  /// int.
  void check_number(Json& value, const Rule& rule, const std::string& where) const {
    const bool fits = value.is_number() &&
                      std::abs(value.get<double>()) <= double{std::numeric_limits<float>::max()};
    if (!fits) refuse(rule, where, "a number that a float can hold");
    const auto number = value.get<double>();
    if (!(number >= rule.low && number <= rule.high)) {
      fail(file_, "{}{} is {:g}, which is out of range", prefix(where), rule.key, number);
    }
    if (rule.kind == Kind::positive && !(number > 0)) {
      fail(file_, "{}{} is {:g}; it must be above 0", prefix(where), rule.key, number);
    }
    value = number;
  }

  void check_numbers(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array of numbers");
    if (rule.length != 0 && value.size() != rule.length) {
      fail(file_, "{}{} has {} numbers, not {}", prefix(where), rule.key, value.size(),
           rule.length);
    }
    for (Json& item : value) check_number(item, rule, where);
  }

  void check_code(Json& value, const Rule& rule, const std::string& where) const {
    check_index(value, rule, where);
    const int code = value.get<int>();
    if (std::find(rule.codes.begin(), rule.codes.end(), code) != rule.codes.end()) return;
    fail(file_, "{}{} is {}, not one of {}", prefix(where), rule.key, code,
         fmt::join(rule.codes.begin(), rule.codes.end(), ", "));
  }

  void check_word(const Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_string()) refuse(rule, where, "a string");
    const auto& text = value.get_ref<const std::string&>();
    if (std::find(rule.words.begin(), rule.words.end(), text) != rule.words.end()) return;
    fail(file_, "{}{} is \"{}\", not one of {}", prefix(where), rule.key, excerpt(text),
         fmt::join(rule.words.begin(), rule.words.end(), ", "));
  }

  void check_indices(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array of integers");
    for (Json& item : value) check_index(item, rule, where);
  }

  void check_index_map(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_object()) refuse(rule, where, "an object");
    for (Json& item : value) check_index(item, rule, where);
  }

  void check_index_maps(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array of objects");
    for (Json& item : value) check_index_map(item, rule, where);
  }

  void check_texts(const Json& value, const Rule& rule, const std::string& where) const {
    bool sound = value.is_array();
    for (const Json& item : value) sound = sound && item.is_string();
    if (!sound) refuse(rule, where, "an array of strings");
  }

  void check_objects(Json& value, const Rule& rule, const std::string& where) const {
    if (!value.is_array()) refuse(rule, where, "an array");
    if (value.size() > rule.length) {
      fail(file_, "{}{} has {} elements (at most {})", prefix(where), rule.key,
           grouped(value.size()), grouped(rule.length));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string item = below(where, fmt::format("{} {}", rule.noun, i));
      if (!value[i].is_object()) fail(file_, "{} is not an object", item);
      check_object(value[i], rule.children, item);
    }
  }

  void check_value(Json& value, const Rule& rule, const std::string& where) const {
    switch (rule.kind) {
      case Kind::index:
        return check_index(value, rule, where);
      case Kind::count:
        return check_integer(value, rule, where, 0, 0x1p53);
      case Kind::size:
        return check_integer(value, rule, where, 1, 0x1p53);
      case Kind::stride:
        return check_stride(value, rule, where);
      case Kind::code:
        return check_code(value, rule, where);
      case Kind::number:
      case Kind::positive:
        return check_number(value, rule, where);
      case Kind::numbers:
        return check_numbers(value, rule, where);
      case Kind::indices:
        return check_indices(value, rule, where);
      case Kind::index_map:
        return check_index_map(value, rule, where);
      case Kind::index_maps:
        return check_index_maps(value, rule, where);
      case Kind::text:
        if (!value.is_string()) refuse(rule, where, "a string");
        return;
      case Kind::texts:
        return check_texts(value, rule, where);
      case Kind::word:
        return check_word(value, rule, where);
      case Kind::boolean:
        if (!value.is_boolean()) refuse(rule, where, "true or false");
        return;
      case Kind::object:
        if (!value.is_object()) refuse(rule, where, "an object");
        return check_object(value, rule.children, below(where, std::string(rule.key)));
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
