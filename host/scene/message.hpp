// How the readers of scenes report an error: one line, `file: element: figures`. In: a file name
// and a fmt format string; out: a dapple::Error of kind input.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "dapple/error.hpp"

namespace dapple {

/// Returns `text` with a space for each control character: names in a file may hold line breaks.
std::string one_line(std::string_view text);

/// Returns `text`, or the beginning of a long one, for messages that quote a file.
std::string excerpt(std::string_view text);

/// Returns "4,800" for 4800.
std::string grouped(std::uint64_t value);

/// Returns `mesh 2 ("leaves")`, or `mesh 2` for an element without a name.
std::string element(std::string_view kind, std::size_t index, std::string_view name);

/// Throws Error input with the text "file: message" in one line; a long message is cut.
[[noreturn]] void fail_with(const std::string& file, const std::string& message);

template <typename... Args>
[[noreturn]] void fail(const std::string& file, fmt::format_string<Args...> format,
                       Args&&... args) {
  fail_with(file, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace dapple
