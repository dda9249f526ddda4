#include "device/programs/sealed_folder.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>

#include "files/checksum.hpp"

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListName = "sealed";

std::optional<std::string> bytes_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;  // reading a pipe could block
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) return std::nullopt;
  return bytes;
}

struct SealedFile {
  fs::path path;
  std::string sum;  ///< hex_text() of its checksum
};

std::string sum_of(std::string_view bytes) { return hex_text(checksum(bytes)); }

std::string line_of(const fs::path& path, std::string_view bytes) {
  return fmt::format("{} {}\n", sum_of(bytes), path.generic_string());
}

bool stays_inside(const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const fs::path& part : path) {
    if (part == "..") return false;
  }
  return true;
}

/// The list of a sealed folder; nothing when the list is damaged. Its last line has the checksum of
/// the lines before.
std::optional<std::vector<SealedFile>> read_list(const fs::path& folder) {
  const auto text = bytes_of(folder / kListName);
  if (!text) return std::nullopt;
  std::vector<SealedFile> files;
  std::istringstream lines(*text);
  std::string before, line;
  while (std::getline(lines, line)) {
    SealedFile file;
    std::istringstream words(line);
    std::string path;
    if (!(words >> file.sum >> path)) return std::nullopt;
    if (path == kListName) {
      if (file.sum == sum_of(before) && lines.peek() == EOF) return files;
      return std::nullopt;
    }
    file.path = path;
    if (!stays_inside(file.path)) return std::nullopt;
    files.push_back(file);
    before += line + '\n';
  }
  return std::nullopt;
}

/// Makes `to` a hard link to `from`, or a copy when that is not possible. False when both fail.
bool link_or_copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  fs::create_hard_link(from, to, error);
  if (!error) return true;
  return fs::copy_file(from, to, error) && !error;
}

}  // namespace

bool seal(const fs::path& folder, const std::vector<fs::path>& files) {
  std::string list;
  for (const fs::path& file : files) {
    const auto bytes = bytes_of(folder / file);
    if (!bytes) return false;
    list += line_of(file, *bytes);
  }
  list += line_of(kListName, list);
  std::ofstream out(folder / kListName, std::ios::binary);
  out << list << std::flush;
  return out.good();
}

std::vector<fs::path> sealed_files(const fs::path& sealed) {
  std::vector<fs::path> paths;
  for (const SealedFile& file : read_list(sealed).value_or(std::vector<SealedFile>{}))
    paths.push_back(file.path);
  return paths;
}

bool unseal(const fs::path& sealed, const fs::path& target, std::vector<fs::path>& files) {
  const auto list = read_list(sealed);
  if (!list) return false;
  // The checksum is taken of the file in `target`: the sealed folder may be replaced at any moment.
  std::vector<fs::path> made;
  for (const SealedFile& file : *list) {
    if (!link_or_copy(sealed / file.path, target / file.path)) break;
    made.push_back(file.path);
    const auto bytes = bytes_of(target / file.path);
    if (!bytes || sum_of(*bytes) != file.sum) break;
    files.push_back(file.path);
  }
  if (files.size() == list->size()) return true;
  std::error_code ignored;
  for (const fs::path& file : made) fs::remove(target / file, ignored);
  files.clear();
  return false;
}

}  // namespace dapple
