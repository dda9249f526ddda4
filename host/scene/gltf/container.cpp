// GLB chunks and the JSON depth scan: see container.hpp.
#include "scene/gltf/container.hpp"

#include <bit>
#include <cstring>

#include "scene/gltf/message.hpp"

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
  return bytes.first(length);
}

}  // namespace

Container split_container(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.empty()) fail(file, "is empty");
  if (bytes.size() < 4 || u32_at(bytes, 0) != kMagic) return {as_text(bytes), {}};
  const auto glb = checked_glb(bytes, file);
  const Chunk json = chunk_at(glb, kHeaderBytes, file);
  if (json.type != kJsonChunk) fail(file, "GLB does not begin with a JSON chunk");
  Container container{as_text(json.data), {}};
  // Padding is spaces by the book and NULs from some writers.
  while (container.json.ends_with('\0')) container.json.remove_suffix(1);
  const std::size_t next = kHeaderBytes + kChunkHeaderBytes + json.data.size();
  if (next < glb.size()) {
    const Chunk binary = chunk_at(glb, next, file);
    if (binary.type == kBinChunk) container.binary = binary.data;
  }
  return container;
}

void check_json_depth(std::string_view json, int max_depth, const std::string& file) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > max_depth) {
        fail(file, "JSON is nested deeper than {} levels (byte {})", max_depth, grouped(i));
      }
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

}  // namespace dapple::gltf
