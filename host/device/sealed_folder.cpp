#include "device/sealed_folder.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>

namespace dapple {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListName = "sealed";

std::optional<std::string> bytes_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;  // a pipe would be waited for
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) return std::nullopt;
  return bytes;
}

struct SealedFile {
  fs::path path;
  std::uint64_t sum = 0;
};

std::string line_of(const fs::path& path, std::uint64_t sum) {
  return fmt::format("{:016x} {}\n", sum, path.generic_string());
}

bool stays_inside(const fs::path& path) {
  if (path.empty() || path.is_absolute()) return false;
  for (const fs::path& part : path) {
    if (part == "..") return false;
  }
  return true;
}

/// The list of a sealed folder; nothing when it is damaged itself. Its last line is the checksum of
/// those before.
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
    if (!(words >> std::hex >> file.sum >> path)) return std::nullopt;
    if (path == kListName) {
      if (file.sum == checksum(before) && lines.peek() == EOF) return files;
      return std::nullopt;
    }
    file.path = path;
    if (!stays_inside(file.path)) return std::nullopt;
    files.push_back(file);
    before += line + '\n';
  }
  return std::nullopt;
}

/// Another name for the file, or where the file system has no such thing a copy.
bool place(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  fs::create_hard_link(from, to, error);
  if (!error) return true;
  return fs::copy_file(from, to, error) && !error;
}

}  // namespace

std::uint64_t checksum(std::string_view bytes, std::uint64_t seed) {
  constexpr std::uint64_t kPrime = 0x9e3779b97f4a7c15;
  std::uint64_t sum = (seed ^ bytes.size()) * kPrime;
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t count = std::min(bytes.size(), sizeof word);
    std::memcpy(&word, bytes.data(), count);
    bytes.remove_prefix(count);
    sum = (sum ^ word) * kPrime;
    sum ^= sum >> 29;
  }
  return sum;
}

bool seal(const fs::path& folder, const std::vector<fs::path>& files) {
  std::string list;
  for (const fs::path& file : files) {
    const auto bytes = bytes_of(folder / file);
    if (!bytes) return false;
    list += line_of(file, checksum(*bytes));
  }
  list += line_of(kListName, checksum(list));
  std::ofstream out(folder / kListName, std::ios::binary);
  out << list << std::flush;
  return out.good();
}

bool unseal(const fs::path& sealed, const fs::path& target, std::vector<fs::path>& files) {
  const auto list = read_list(sealed);
  if (!list) return false;
  // What was placed is what is read: the sealed folder may be replaced at any moment.
  std::vector<fs::path> placed;
  for (const SealedFile& file : *list) {
    if (!place(sealed / file.path, target / file.path)) break;
    placed.push_back(file.path);
    const auto bytes = bytes_of(target / file.path);
    if (!bytes || checksum(*bytes) != file.sum) break;
    files.push_back(file.path);
  }
  if (files.size() == list->size()) return true;
  std::error_code ignored;
  for (const fs::path& file : placed) fs::remove(target / file, ignored);
  files.clear();
  return false;
}

}  // namespace dapple
