// The scene of sound_scene.hpp, with one property at a time that has a value of a wrong type. Each
// property that occurs in the scene is tested once.
#include <algorithm>
#include <cctype>
#include <set>

#include "corpus/corpus.hpp"
#include "corpus/sound_scene.hpp"

namespace dapple::test {
namespace {

/// "/meshes/0/primitives/1/mode" becomes "meshes_primitives_mode", so that elements of the same
/// kind have one name.
std::string property_name(const std::string& pointer) {
  std::string name;
  std::string part;
  const auto add_part = [&] {
    const bool index = !part.empty() && std::all_of(part.begin(), part.end(), [](unsigned char c) {
      return std::isdigit(c) != 0;
    });
    if (!part.empty() && !index) name += (name.empty() ? "" : "_") + part;
    part.clear();
  };
  for (const char c : pointer) {
    if (c == '/') {
      add_part();
    } else {
      part += c;
    }
  }
  add_part();
  return name;
}

/// Appends JSON pointers to all values below `value`. Arrays of numbers or strings are one value.
void collect(const json& value, const std::string& pointer, std::vector<std::string>& pointers) {
  if (!pointer.empty()) pointers.push_back(pointer);
  const bool leaf_array = value.is_array() && !value.empty() && !value[0].is_structured();
  if (!value.is_structured() || leaf_array) return;
  for (const auto& [key, item] : value.items()) collect(item, pointer + "/" + key, pointers);
}

/// A value of another type: numbers, objects and arrays become strings; strings and booleans become
/// numbers.
json wrong_value(const json& value) {
  if (value.is_number()) return "7";
  if (value.is_string()) return 7;
  if (value.is_boolean()) return 1;
  return "none";
}

json null_or_nested(const json& value) {
  return value.is_structured() ? json(nullptr) : json::array({value});
}

}  // namespace

void add_wrong_types(MalformedCases& cases) {
  const GltfBuilder sound = sound_scene();
  std::vector<std::string> pointers;
  collect(sound.doc, "", pointers);
  std::set<std::string> seen;
  bool second = false;
  for (const std::string& pointer : pointers) {
    const std::string name = property_name(pointer);
    if (!seen.insert(name +
                     (std::isdigit(static_cast<unsigned char>(pointer.back())) ? "_item" : ""))
             .second) {
      continue;
    }
    GltfBuilder damaged = sound;
    json& value = damaged.doc[json::json_pointer(pointer)];
    value = second ? null_or_nested(value) : wrong_value(value);
    const bool item = std::isdigit(static_cast<unsigned char>(pointer.back())) != 0;
    cases.push_back({"type_" + name + (item ? "_item" : ""), as_glb(damaged), "scene.glb: "});
    second = !second;
  }
}

}  // namespace dapple::test
