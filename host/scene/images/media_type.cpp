#include "scene/images/media_type.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>

namespace dapple {
namespace {

struct Format {
  const char* type;
  std::size_t offset;  ///< of the signature
  std::string_view signature;
  std::string_view suffix;
};

// WebP is a RIFF file, AVIF an ISO base media file: what follows their lengths tells them.
constexpr Format kFormats[] = {
    {"image/png", 0, "\x89PNG\r\n\x1a\n", ".png"}, {"image/jpeg", 0, "\xff\xd8", ".jpg"},
    {"image/jpeg", 0, "\xff\xd8", ".jpeg"},        {"image/webp", 8, "WEBP", ".webp"},
    {"image/ktx2", 0, "\xabKTX 20\xbb", ".ktx2"},  {"image/vnd-ms.dds", 0, "DDS ", ".dds"},
    {"image/avif", 4, "ftypavif", ".avif"},        {"image/avif", 4, "ftypavis", ".avif"},
};

}  // namespace

std::string image_media_type(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::string_view begin(reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 16));
  for (const Format& format : kFormats)
    if (begin.size() > format.offset && begin.substr(format.offset).starts_with(format.signature))
      return format.type;
  std::string suffix = std::filesystem::path(name).extension().string();
  for (char& c : suffix) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Format& format : kFormats)
    if (suffix == format.suffix) return format.type;
  return "image/png";
}

}  // namespace dapple
