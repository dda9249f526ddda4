// Options whose value is one of a few words. In: the flag and its text. Out: what the word means.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "dapple/error.hpp"

namespace dapple {

/// The value of the word that equals `text`. Throws Error usage, which lists the words in order.
template <class Value>
Value parse_choice(const std::string& flag, const std::string& text,
                   const std::vector<std::pair<const char*, Value>>& choices) {
  std::string words;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const auto& [word, value] = choices[i];
    if (text == word) return value;
    words += i == 0 ? "" : i + 1 == choices.size() ? " or " : ", ";
    words += word;
  }
  throw Error(ErrorKind::usage, fmt::format("{} {}: it is {}", flag, text, words));
}

}  // namespace dapple
