#include "commands/bake/side_copies.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "dapple/error.hpp"
#include "files/output_file.hpp"
#include "film/exr/exr_output.hpp"
#include "scene/gltf/document/file_uris.hpp"
#include "scene/gltf/document/uri.hpp"

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

/// The JSON of a .gltf or .glb file; not an object if the file is not there, or is something else.
nlohmann::json document_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::array<char, 20> head{};  // of a GLB: magic, version, length; length and type of the JSON
  stream.read(head.data(), head.size());
  if (!stream || std::string_view(head.data(), 4) != "glTF") {
    stream.clear();
    stream.seekg(0);
    return nlohmann::json::parse(stream, nullptr, false);
  }
  std::uint32_t length = 0;
  std::memcpy(&length, &head[12], sizeof length);
  constexpr std::uint32_t kMost = 1u << 28;
  std::string text(std::min(length, kMost), ' ');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  return nlohmann::json::parse(text, nullptr, false);
}

/// Files that a glTF file names: an earlier bake's output may be there, with its copies.
std::set<fs::path> files_of(const fs::path& output) {
  std::set<fs::path> files;
  const nlohmann::json document = document_of(output);
  if (!document.is_object()) return files;
  gltf::for_each_uri(document, [&](const std::string& uri, bool) {
    files.insert((output.parent_path() / gltf::percent_decode(uri)).lexically_normal());
  });
  return files;
}

/// Whether an earlier bake wrote the file: its metadata tell the rays of a value.
bool is_baked_exr(const std::string& path) {
  if (!path.ends_with(".exr")) return false;
  try {
    const auto settings = read_exr_metadata(path).settings;
    return std::any_of(settings.begin(), settings.end(),
                       [](const auto& setting) { return setting.first == "rays"; });
  } catch (const Error&) {
    return false;
  }
}

/// Throws Error usage if the file cannot be written. Folders below `parent` are not there yet.
void check_target(const fs::path& to, const fs::path& parent) {
  std::error_code ignored;
  if (fs::is_directory(fs::absolute(to, ignored).parent_path(), ignored)) {
    check_output_path(to.string());
    remove_abandoned_beside(to.string());
  } else if (access(parent.c_str(), W_OK | X_OK) != 0) {
    throw Error(ErrorKind::usage, parent.string() + " cannot be written to");
  }
}

}  // namespace

void check_side_copies(const std::string& output,
                       const std::vector<std::pair<std::string, std::string>>& copies) {
  const auto refuse = [&](const std::string& from, const std::string& why) {
    throw Error(ErrorKind::usage,
                fmt::format("--output {}: {} is copied beside it, but {}; write to another folder, "
                            "{}or remove what is there",
                            output, from, why,
                            output.ends_with(".glb") ? "" : "or a .glb, which embeds all, "));
  };
  const std::set<fs::path> earlier = copies.empty() ? std::set<fs::path>{} : files_of(output);
  for (const auto& [from, to] : copies) {
    std::error_code ignored;
    const fs::path parent = nearest_parent(to);
    if (!fs::is_directory(parent, ignored)) refuse(from, parent.string() + " is not a folder");
    try {
      check_target(to, parent);
    } catch (const Error& error) {
      refuse(from, error.what());
    }
    if (fs::exists(to, ignored) && !earlier.contains(fs::path(to).lexically_normal()) &&
        !have_same_content(from, to))
      refuse(from, to + " is another file of that name");
  }
}

void check_new_sides(const std::string& output, const std::vector<std::string>& paths) {
  std::error_code ignored;
  for (const std::string& path : paths) {
    if (!fs::exists(path, ignored) || is_baked_exr(path) ||
        files_of(output).contains(fs::path(path).lexically_normal()))
      continue;
    throw Error(
        ErrorKind::usage,
        fmt::format("--output {}: {} is written beside it, but another file of that name "
                    "is there; write to another folder, {}or remove what is there",
                    output, path, path.ends_with(".exr") ? "" : "or a .glb, which embeds all, "));
  }
}

}  // namespace dapple
