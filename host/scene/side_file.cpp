#include "scene/side_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "dapple/error.hpp"

namespace dapple {

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::input, path + ": " + what);
}

std::uintmax_t checked_size(const std::string& path, const char* kind, std::uintmax_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, fmt::format("there is no such {}", kind));
  // Reading a pipe or a device might never end.
  if (!std::filesystem::is_regular_file(status)) fail(path, "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) fail(path, error.message());
  if (size > max_bytes)
    fail(path, fmt::format("has {} bytes; a {} may have {}", size, kind, max_bytes));
  return size;
}

std::vector<std::uint8_t> read_start(const std::string& path, std::uintmax_t count) {
  std::vector<std::uint8_t> bytes(count);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count)))
    fail(path, "cannot be read");
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> read_side_file(const std::string& path, const char* kind,
                                         std::uintmax_t max_bytes) {
  return read_start(path, checked_size(path, kind, max_bytes));
}

std::vector<std::uint8_t> read_side_file_start(const std::string& path, const char* kind,
                                               std::uintmax_t max_bytes) {
  constexpr std::uintmax_t kStart = 16;
  return read_start(path, std::min(kStart, checked_size(path, kind, max_bytes)));
}

}  // namespace dapple
