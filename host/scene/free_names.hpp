// Names that are all different. In: names that may be equal. Out: "rose", "rose_2", "rose_3".
#pragma once

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>

namespace dapple {

class FreeNames {
 public:
  /// Names that take() does not return.
  void reserve(const std::string& name) { taken_.insert(name); }

  /// Returns the name, or if it is taken, with the lowest number from 2 on with which it is free.
  std::string take(const std::string& name) {
    std::string free = name;
    // Lower numbers are taken: many lights may have one name.
    while (!taken_.insert(free).second)
      free = fmt::format("{}_{}", name, ++last_.try_emplace(name, 1).first->second);
    return free;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> last_;
};

}  // namespace dapple
