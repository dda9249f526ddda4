// How the readers of scenes report what is wrong: one line, `file: element: figures`. In come
// a file name and a fmt format string; out goes a dapple::Error of kind input.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "dapple/error.hpp"

namespace dapple {

/// `text` with control characters replaced: names in a file may hold line breaks.
std::string one_line(std::string_view text);

/// The beginning of a long text, for messages that quote a file.
std::string excerpt(std::string_view text);

/// 4800 as "4,800".
std::string grouped(std::uint64_t value);

/// `mesh 2 ("leaves")`, or `mesh 2` for an element without a name.
std::string element(std::string_view kind, std::size_t index, std::string_view name);

[[noreturn]] void fail_with(const std::string& file, const std::string& message);

template <typename... Args>
[[noreturn]] void fail(const std::string& file, fmt::format_string<Args...> format,
                       Args&&... args) {
  fail_with(file, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace dapple
