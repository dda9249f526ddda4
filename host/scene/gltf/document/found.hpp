// Counts what a note is about. In: elements of a file. Out: the note, which names the first of them
// and how many there are.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "scene/message.hpp"

namespace dapple::gltf {

/// How often something was found, and where first.
struct Found {
  std::uint64_t count = 0;
  std::string first;  ///< the element, for messages

  void add(std::uint64_t more, const std::string& who) {
    if (more > 0 && count == 0) first = who;
    count += more;
  }

  /// Returns "mesh 0 has no primitives (3 of them)" for `what` "has no primitives"; empty if
  /// nothing was found.
  [[nodiscard]] std::string note(const char* what) const {
    if (count == 0) return {};
    return fmt::format("{} {}{}", first, what,
                       count > 1 ? fmt::format(" ({} of them)", grouped(count)) : "");
  }
};

}  // namespace dapple::gltf
