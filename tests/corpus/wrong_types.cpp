// Every property of a scene that has them all, once with a value of a type that it cannot have.
#include <algorithm>
#include <cctype>
#include <set>

#include "corpus/corpus.hpp"
#include "corpus/sound_scene.hpp"

namespace dapple::test {
namespace {

/// "/meshes/0/primitives/1/mode" as "meshes_primitives_mode": elements of a kind count once.
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

/// Pointers to all values below `value`, arrays of numbers or strings as one.
void collect(const json& value, const std::string& pointer, std::vector<std::string>& pointers) {
  if (!pointer.empty()) pointers.push_back(pointer);
  const bool leaf_array = value.is_array() && !value.empty() && !value[0].is_structured();
  if (!value.is_structured() || leaf_array) return;
  for (const auto& [key, item] : value.items()) collect(item, pointer + "/" + key, pointers);
}

/// A number is never an object, an array never a number, a string never either.
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
