// Values of enumerations by the names that the command line gives them.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "dapple/error.hpp"

namespace dapple::python {

template <class Value, std::size_t N>
using Names = std::array<std::pair<const char*, Value>, N>;

/// The value called `chosen`. Throws Error usage, which lists the names, if there is none; `what`:
/// the argument.
template <class Value, std::size_t N>
Value value_of(const char* what, const std::string& chosen, const Names<Value, N>& names) {
  std::string known;
  for (const auto& [text, value] : names) {
    if (chosen == text) return value;
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  throw Error(ErrorKind::usage, std::string(what) + " is \"" + chosen + "\"; known are " + known);
}

}  // namespace dapple::python
