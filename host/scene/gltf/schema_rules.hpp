// What the schema check knows of glTF's properties: a tree of rules, by key.
#pragma once

#include <cstddef>
#include <string_view>

namespace dapple::gltf {

enum class Kind {
  index,      ///< integer in [0, 2^31)
  count,      ///< integer in [0, 2^53)
  stride,     ///< integer in [4, 252], a multiple of 4
  number,     ///< finite as a float
  numbers,    ///< array of such numbers
  indices,    ///< array of index
  index_map,  ///< object of index
  text,
  texts,
  component_type,  ///< 5120 to 5123, 5125 or 5126
  element_type,    ///< "SCALAR", "VEC2" and so on
  camera_type,
  boolean,
  object,
  objects,  ///< array of objects
};

struct Rule;

/// A table of rules; a span would need Rule to be complete.
struct Rules {
  const Rule* first = nullptr;
  std::size_t count = 0;
  constexpr Rules() = default;
  template <std::size_t N>
  constexpr Rules(const Rule (&rules)[N]) : first(rules), count(N) {}
  [[nodiscard]] const Rule* begin() const;
  [[nodiscard]] const Rule* end() const;
};

struct Rule {
  std::string_view key;
  Kind kind;
  Rules children = {};         ///< of object and objects
  std::string_view noun = {};  ///< of objects: what a message calls one of them
  std::size_t length = 0;      ///< of numbers; 0 for any
  bool required = false;
};

inline const Rule* Rules::begin() const { return first; }
inline const Rule* Rules::end() const { return first + count; }

/// The rules of a document's root.
Rules document_rules();

}  // namespace dapple::gltf
