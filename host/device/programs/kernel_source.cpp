#include "device/programs/kernel_source.hpp"

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "dapple/error.hpp"
#include "files/checksum.hpp"

namespace dapple {
namespace {

std::string read_source(const std::string& name, const std::string& kernel_dir) {
  if (!kernel_dir.empty()) {
    std::ifstream file(std::filesystem::path(kernel_dir) / name);
    if (file) return {std::istreambuf_iterator<char>(file), {}};
  }
  for (const EmbeddedSource& source : embedded_sources()) {
    if (source.name == name) return std::string(source.text);
  }
  throw Error(ErrorKind::failed,
              "kernel file " + name + " is neither built in nor in '" + kernel_dir + "'");
}

/// The name in `#include "name"`; empty for other lines.
std::string included_name(const std::string& line) {
  constexpr std::string_view kDirective = "#include \"";
  if (!line.starts_with(kDirective)) return {};
  const auto end = line.find('"', kDirective.size());
  return line.substr(kDirective.size(), end - kDirective.size());
}

void expand(const std::string& name, const std::string& kernel_dir, std::set<std::string>& seen,
            std::string& out) {
  if (!seen.insert(name).second) return;
  std::istringstream lines(read_source(name, kernel_dir));
  out += "#line 1 \"" + name + "\"\n";
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string included = included_name(line);
    if (included.empty()) {
      out += line + '\n';
      continue;
    }
    expand(included, kernel_dir, seen, out);
    out += "#line " + std::to_string(number + 1) + " \"" + name + "\"\n";
  }
}

}  // namespace

std::string expand_kernel(const std::string& file, const std::string& kernel_dir) {
  std::set<std::string> seen;
  std::string out;
  expand(file, kernel_dir, seen, out);
  return out;
}

std::string kernel_checksum(const std::string& kernel_dir) {
  ChecksumStream stream;
  for (const EmbeddedSource& source : embedded_sources()) {
    if (source.name.ends_with(".cl"))
      stream.add_range(expand_kernel(std::string(source.name), kernel_dir));
  }
  return hex_text(stream.value());
}

}  // namespace dapple
