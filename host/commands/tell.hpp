// Prints results on the standard output, notes and progress on the standard error. Unlike
// fmt::print() these do not throw where nobody reads them: a picture that is right is not spoilt by
// a closed terminal, and work goes on when a reader is lost.
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>

namespace dapple {

template <typename... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

/// The errno of the first write to the standard output that failed; 0: none did.
inline int& output_failure() {
  static int failure = 0;
  return failure;
}

inline void keep_output_failure(bool failed) {
  if (failed && output_failure() == 0) output_failure() = errno;
}

template <typename... Args>
void put(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  keep_output_failure(std::fwrite(text.data(), 1, text.size(), stdout) != text.size());
}

/// Writes what put() has kept back.
inline void put_now() { keep_output_failure(std::fflush(stdout) != 0); }

}  // namespace dapple
