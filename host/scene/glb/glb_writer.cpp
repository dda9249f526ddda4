// Writes a scene as one GLB file (glTF 2.0 Specification, section 4). In: a scene and a path; out:
// the file. The same scene always gives the same bytes.
#include <fmt/format.h>

#include <limits>
#include <string_view>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/check/scene_check.hpp"
#include "scene/glb/glb_bytes.hpp"
#include "scene/glb/glb_layout.hpp"

namespace dapple {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67;  // "glTF"
constexpr std::uint32_t kGlbVersion = 2;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

// Appends 32 bits in little-endian order, which GLB uses on every machine.
void append_word(std::string& out, std::size_t word) {
  for (std::size_t i = 0; i < 4; ++i) out += static_cast<char>((word >> (8 * i)) & 0xff);
}

}  // namespace

void write_glb_bytes(PendingFile& file, std::string json, std::span<const std::string_view> binary,
                     std::string_view others) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::size_t byte_count = 0;
  for (const std::string_view section : binary) byte_count += section.size();
  const std::size_t total = kHeaderBytes + kChunkHeaderBytes + json.size() +
                            (byte_count > 0 ? kChunkHeaderBytes + byte_count : 0) + others.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    file.fail(fmt::format("it would have {} bytes; a GLB file has room for 4294967295", total));
  }
  std::string header, binary_header;
  for (const std::size_t word : {std::size_t{kGlbMagic}, std::size_t{kGlbVersion}, total,
                                 json.size(), std::size_t{kJsonChunk}}) {
    append_word(header, word);
  }
  std::vector<std::string_view> sections{header, json};
  if (byte_count > 0) {
    append_word(binary_header, byte_count);
    append_word(binary_header, kBinChunk);
    sections.push_back(binary_header);
    sections.insert(sections.end(), binary.begin(), binary.end());
  }
  sections.push_back(others);
  for (const std::string_view section : sections) file.write(section.data(), section.size());
  file.close();
  file.verify();
}

void write_glb(const Scene& scene, const std::string& path) {
  check_geometry(scene);
  const GlbLayout layout = lay_out_glb(scene);
  std::vector<std::string_view> binary;
  for (const auto& section : layout.sections)
    binary.emplace_back(reinterpret_cast<const char*>(section.data()), section.size());
  PendingFile file(path);
  write_glb_bytes(file, layout.json, binary);
  file.commit();
}

}  // namespace dapple
