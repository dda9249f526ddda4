#include "film/memory_limit.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The number in a file; infinity if there is none, as for "max".
double number_in(const fs::path& file) {
  std::ifstream stream(file);
  double bytes = 0;
  return stream >> bytes ? bytes : kNone;
}

/// The least number in `file` of the folder `group` below `root` and of the folders above it.
double least_above(const fs::path& root, const std::string& group, const char* file) {
  double least = number_in(root / file);
  fs::path folder = root;
  for (const fs::path& name : fs::path(group).relative_path()) {
    folder /= name;
    least = std::min(least, number_in(folder / file));
  }
  return least;
}

}  // namespace

// A line is NUMBER:CONTROLLERS:GROUP; version 2 has number 0 and no controllers.
double group_limit(std::string_view membership, const fs::path& root) {
  double least = kNone;
  std::istringstream lines{std::string(membership)};
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string_view text = line;
    const std::string controllers = fmt::format(",{},", text.substr(first + 1, second - first - 1));
    const std::string group(text.substr(second + 1));
    if (controllers == ",,") least = std::min(least, least_above(root, group, "memory.max"));
    if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, least_above(root / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

double machine_bytes() {
  const double physical =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  std::ifstream stream("/proc/self/cgroup");
  const std::string membership{std::istreambuf_iterator<char>(stream), {}};
  return std::min(physical, group_limit(membership, "/sys/fs/cgroup"));
}

}  // namespace dapple
