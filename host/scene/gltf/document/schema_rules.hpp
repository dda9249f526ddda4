// The rules of the schema check: a tree that has a rule for each property of glTF, by key. Out: the
// rules of a document's root, for schema.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

namespace dapple::gltf {

enum class Kind {
  index,       ///< integer in [0, 2^31)
  count,       ///< integer in [0, 2^53)
  size,        ///< integer in [1, 2^53)
  stride,      ///< integer in [4, 252], a multiple of 4
  code,        ///< one of the rule's codes
  number,      ///< finite as a float, in [low, high]
  positive,    ///< finite as a float, above 0
  numbers,     ///< array of `number`
  indices,     ///< array of index
  index_map,   ///< object of index
  index_maps,  ///< array of objects of index
  text,
  texts,
  word,  ///< a string, one of the rule's words
  boolean,
  object,
  objects,  ///< array of objects, at most `length`
};

struct Rule;

/// A table that a rule refers to; a span would need Rule to be complete.
template <typename Item>
struct Table {
  const Item* first = nullptr;
  std::size_t count = 0;
  constexpr Table() = default;
  template <std::size_t N>
  constexpr Table(const Item (&items)[N]) : first(items), count(N) {}
  [[nodiscard]] const Item* begin() const { return first; }
  [[nodiscard]] const Item* end() const { return first + count; }
};

using Rules = Table<Rule>;

struct Rule {
  std::string_view key;
  Kind kind;
  Rules children = {};         ///< for object and objects
  std::string_view noun = {};  ///< for objects: the name of one of them in messages
  std::size_t length = 0;      ///< numbers: their count, 0 for any; objects: the maximum count
  bool required = false;
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
  Table<std::string_view> words = {};
  Table<int> codes = {};
};

/// The rules of a document's root.
Rules document_rules();

}  // namespace dapple::gltf
