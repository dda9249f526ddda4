// Checks the chunks of PNG (ISO/IEC 15948) and the segments of JPEG (ITU-T T.81, annex B): see
// image_structure.hpp.
#include "scene/images/image_structure.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

namespace dapple {
namespace {

using Span = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kChunkOverhead = 12;  // length, type, checksum

/// The decoder visits all pixels for each scan of a progressive JPEG, and a scan can be as short as
/// three bytes.
constexpr int kMaxScans = 100;

std::uint32_t big_endian(Span bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
    table[i] = crc;
  }
  return table;
}();

std::uint32_t crc32(Span bytes) {
  std::uint32_t crc = ~0u;
  for (const std::uint8_t byte : bytes) crc = (crc >> 8) ^ kCrcTable[(crc ^ byte) & 0xffu];
  return ~crc;
}

std::string_view chunk_type(Span chunk) {
  return {reinterpret_cast<const char*>(chunk.data()) + 4, 4};
}

/// Whether a marker has no length field and no data: TEM and the restart markers.
bool has_no_length(std::uint8_t marker) {
  return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7);
}

/// Returns the offset of the first marker after a scan's compressed data. Restart markers and
/// stuffed bytes (0xff 0x00) belong to the data.
std::size_t after_scan(Span bytes, std::size_t at) {
  while (at + 1 < bytes.size()) {
    const std::uint8_t marker = bytes[at + 1];
    const bool inside = marker == 0x00 || (marker >= 0xd0 && marker <= 0xd7);
    if (bytes[at] == 0xff && marker != 0xff && !inside) return at;
    ++at;
  }
  return bytes.size();
}

/// Checks the tables of a DHT segment. The decoder has room for 256 codes per table, does not check
/// their number, and treats the last of 256 as no code. Real tables have at most 162.
std::string huffman_defect(Span tables) {
  constexpr std::size_t kHead = 17;  // one byte of class and number, 16 counts of codes by length
  while (!tables.empty()) {
    if (tables.size() < kHead) return "its JPEG data is cut off";
    const Span lengths = tables.subspan(1, kHead - 1);
    const std::size_t codes = std::accumulate(lengths.begin(), lengths.end(), std::size_t{0});
    if (codes > 255) return "a Huffman table of its JPEG data has more than 255 codes";
    if (tables.size() < kHead + codes) return "its JPEG data is cut off";
    tables = tables.subspan(kHead + codes);
  }
  return "";
}

}  // namespace

ImageFormat image_format(Span bytes) {
  if (bytes.size() >= kPngSignature.size() &&
      std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) {
    return ImageFormat::png;
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("RIFF") && text.size() >= 12 && text.substr(8, 4) == "WEBP")
    return ImageFormat::webp;
  const bool jpeg = bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
  return jpeg ? ImageFormat::jpeg : ImageFormat::other;
}

std::string png_defect(Span bytes) {
  bool has_pixels = false;
  std::size_t at = kPngSignature.size();
  for (bool first = true;; first = false) {
    if (bytes.size() - at < kChunkOverhead) return "its PNG data is cut off";
    const Span rest = bytes.subspan(at);
    const std::uint32_t length = big_endian(rest.first(4));
    if (length > rest.size() - kChunkOverhead) return "its PNG data is cut off";
    const std::string_view type = chunk_type(rest);
    if (first && (type != "IHDR" || length != 13)) return "its PNG header";
    if (crc32(rest.subspan(4, 4 + std::size_t{length})) !=
        big_endian(rest.subspan(8 + std::size_t{length}, 4))) {
      return "a PNG checksum is wrong";
    }
    has_pixels = has_pixels || type == "IDAT";
    if (type == "IEND") return has_pixels ? "" : "its PNG data has no pixels";
    at += kChunkOverhead + length;
  }
}

std::string jpeg_defect(Span bytes) {
  int scans = 0;
  std::size_t at = 2;
  while (at + 1 < bytes.size()) {
    if (bytes[at] != 0xff) return "its JPEG segments do not follow each other";
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xd9) return scans > 0 ? "" : "its JPEG data has no pixels";
    if (marker == 0xff || has_no_length(marker)) {
      at += marker == 0xff ? 1 : 2;
      continue;
    }
    if (bytes.size() - at < 4) break;
    const std::uint32_t length = big_endian(bytes.subspan(at + 2, 2));
    if (length < 2 || length > bytes.size() - at - 2) break;
    if (marker == 0xc4) {
      std::string defect = huffman_defect(bytes.subspan(at + 4, length - 2));
      if (!defect.empty()) return defect;
    }
    at += 2 + length;
    if (marker != 0xda) continue;
    if (++scans > kMaxScans) return "its JPEG data has more than 100 scans";
    at = after_scan(bytes, at);
  }
  return "its JPEG data is cut off";
}

}  // namespace dapple
