// Reading regular files whole: see file.hpp.
#include "scene/gltf/file.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

namespace fs = std::filesystem;

/// The size of `path`, once it is known that opening it cannot block.
std::uint64_t regular_file_size(const fs::path& path, const std::string& what) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) fail(what, "no such file");
  if (error) fail(what, "cannot be read ({})", error.message());
  if (fs::is_directory(status)) fail(what, "is a folder, not a file");
  if (!fs::is_regular_file(status)) fail(what, "is not a regular file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) fail(what, "cannot be read ({})", error.message());
  if (size > kMaxFileBytes) {
    fail(what, "is too large ({} bytes, at most {})", grouped(size), grouped(kMaxFileBytes));
  }
  return size;
}

}  // namespace

Bytes read_file(const fs::path& path, const std::string& what, std::uint64_t max_bytes) {
  const std::uint64_t size = std::min(regular_file_size(path, what), max_bytes);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(what, "cannot be opened (is it readable?)");
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(stream.gcount()) != size) {
    fail(what, "ends early (read {} of {} bytes)",
         grouped(static_cast<std::uint64_t>(stream.gcount())), grouped(size));
  }
  return bytes;
}

}  // namespace dapple::gltf
