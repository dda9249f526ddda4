#include "commands/side_copies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "dapple/error.hpp"
#include "files/output_file.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

bool have_same_content(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::file_size(a, error) != fs::file_size(b, error) || error) return false;
  std::ifstream stream_a(a, std::ios::binary), stream_b(b, std::ios::binary);
  std::array<char, 1 << 16> bytes_a{}, bytes_b{};
  while (stream_a && stream_b) {
    stream_a.read(bytes_a.data(), bytes_a.size());
    stream_b.read(bytes_b.data(), bytes_b.size());
    const auto count = stream_a.gcount();
    if (count != stream_b.gcount() ||
        !std::equal(bytes_a.begin(), bytes_a.begin() + count, bytes_b.begin()))
      return false;
  }
  return stream_a.eof() && stream_b.eof();
}

/// The folder of `path`, or the nearest one above that exists, which may be no folder.
fs::path nearest_parent(const fs::path& path) {
  std::error_code ignored;
  fs::path parent = fs::absolute(path, ignored).lexically_normal().parent_path();
  while (!fs::exists(fs::symlink_status(parent, ignored)) && parent.has_relative_path())
    parent = parent.parent_path();
  return parent;
}

}  // namespace

void check_side_copies(const std::string& output,
                       const std::vector<std::pair<std::string, std::string>>& copies) {
  const auto refuse = [&](const std::string& from, const std::string& why) {
    throw Error(ErrorKind::usage,
                fmt::format("--output {}: {} is copied beside it, but {}; write to another folder, "
                            "or a .glb, which embeds all, or remove what is there",
                            output, from, why));
  };
  for (const auto& [from, to] : copies) {
    std::error_code ignored;
    const fs::path parent = nearest_parent(to);
    if (!fs::is_directory(parent, ignored)) refuse(from, parent.string() + " is not a folder");
    if (fs::is_directory(fs::path(to).parent_path(), ignored)) {
      try {
        check_output_path(to);
      } catch (const Error& error) {
        refuse(from, error.what());
      }
    }
    if (fs::exists(to, ignored) && !have_same_content(from, to))
      refuse(from, to + " is another file of that name");
  }
}

}  // namespace dapple
