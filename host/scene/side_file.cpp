#include "scene/side_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "dapple/error.hpp"

namespace dapple {

std::vector<std::uint8_t> read_side_file(const std::string& path, const char* kind,
                                         std::uintmax_t max_bytes) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::input, path + ": " + what);
  };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(fmt::format("there is no such {}", kind));
  // Reading a pipe or a device might never end.
  if (!std::filesystem::is_regular_file(status)) fail("is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) fail(error.message());
  if (size > max_bytes) fail(fmt::format("has {} bytes; a {} may have {}", size, kind, max_bytes));
  std::vector<std::uint8_t> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    fail("cannot be read");
  return bytes;
}

}  // namespace dapple
