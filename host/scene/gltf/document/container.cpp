// Reads the header and the chunks of GLB (glTF 2.0 Specification, section 4): see container.hpp.
#include "scene/gltf/document/container.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <filesystem>

#include "scene/message.hpp"

static_assert(std::endian::native == std::endian::little, "glTF's bytes are read in place");

namespace dapple::gltf {
namespace {

constexpr std::uint32_t kMagic = 0x46546c67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004e4942;   // "BIN"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct Chunk {
  std::uint32_t type;
  std::span<const std::uint8_t> data;
};

Chunk chunk_at(std::span<const std::uint8_t> glb, std::size_t offset, const std::string& file) {
  const std::size_t left = glb.size() - offset;
  if (left < kChunkHeaderBytes) {
    fail(file, "GLB chunk header at byte {} is cut off", grouped(offset));
  }
  const std::uint32_t length = u32_at(glb, offset);
  if (length > left - kChunkHeaderBytes) {
    fail(file, "GLB chunk at byte {} reads past the file (needs {} bytes, has {})", grouped(offset),
         grouped(length), grouped(left - kChunkHeaderBytes));
  }
  if (length % 4 != 0) {
    fail(file, "GLB chunk at byte {} has {} bytes, not a multiple of 4", grouped(offset),
         grouped(length));
  }
  return {u32_at(glb, offset + 4), glb.subspan(offset + kChunkHeaderBytes, length)};
}

std::span<const std::uint8_t> checked_glb(std::span<const std::uint8_t> bytes,
                                          const std::string& file) {
  if (bytes.size() < kHeaderBytes) fail(file, "GLB header is cut off");
  const std::uint32_t version = u32_at(bytes, 4);
  if (version != 2) fail(file, "is GLB version {}; only version 2 can be read", version);
  const std::uint32_t length = u32_at(bytes, 8);
  if (length < kHeaderBytes || length > bytes.size()) {
    fail(file, "GLB header says {} bytes, but the file has {}", grouped(length),
         grouped(bytes.size()));
  }
  // Some file systems and archives append zeros; other bytes mean that a length is wrong.
  const auto after = bytes.subspan(length);
  if (std::any_of(after.begin(), after.end(), [](std::uint8_t byte) { return byte != 0; })) {
    fail(file, "GLB header says {} bytes, but the file goes on for {} more", grouped(length),
         grouped(after.size()));
  }
  return bytes.first(length);
}

/// Throws if a file whose text is no JSON object has the name of another format.
void check_format(std::string_view text, const std::string& file) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != std::string_view::npos && text[first] == '{') return;
  std::string ending = std::filesystem::path(file).extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* other :
       {".obj", ".ply", ".stl", ".fbx", ".usd", ".usda", ".usdc", ".abc", ".blend"})
    if (ending == other)
      fail(file,
           "is not glTF; scenes are glTF (.gltf, .glb) or HAIR files (.hair): export or convert it "
           "to glTF");
}

}  // namespace

Container split_container(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.empty()) fail(file, "is empty");
  if (bytes.size() < 4 || u32_at(bytes, 0) != kMagic) {
    check_format(as_text(bytes), file);
    return {as_text(bytes), {}, {}};
  }
  const auto glb = checked_glb(bytes, file);
  const Chunk json = chunk_at(glb, kHeaderBytes, file);
  if (json.type != kJsonChunk) fail(file, "GLB does not begin with a JSON chunk");
  Container container{as_text(json.data), {}, {}};
  // The specification pads with spaces, some writers with NULs.
  while (container.json.ends_with('\0')) container.json.remove_suffix(1);
  std::size_t next = kHeaderBytes + kChunkHeaderBytes + json.data.size();
  for (int number = 1; next < glb.size(); ++number) {
    const Chunk chunk = chunk_at(glb, next, file);
    if (chunk.type == kJsonChunk)
      fail(file, "GLB has a second JSON chunk at byte {}", grouped(next));
    if (chunk.type == kBinChunk && number > 1) {
      fail(file, "GLB has its BIN chunk at byte {}; it can only be the second chunk",
           grouped(next));
    }
    if (chunk.type == kBinChunk)
      container.binary = chunk.data;
    else if (container.others.empty())
      container.others = as_text(glb.subspan(next));
    next += kChunkHeaderBytes + chunk.data.size();
  }
  return container;
}

}  // namespace dapple::gltf
