// Prints notes and progress on the standard error. Unlike fmt::print() it does not throw where
// nobody reads them: a picture that is right is not spoilt by a closed terminal.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace dapple {

template <typename... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

}  // namespace dapple
