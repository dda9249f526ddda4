// GLB files whose header, chunks or lengths are wrong, and files of other formats.
#include "corpus/corpus.hpp"

namespace dapple::test {
namespace {

constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinChunk = 0x004e4942;
constexpr std::uint32_t kOtherChunk = 0x58585858;

Malformed bytes_case(const std::string& name, const Bytes& bytes, const std::string& says) {
  return {"container_" + name, {"scene.glb", {{"scene.glb", bytes}}, {}}, says};
}

Bytes text_bytes(const std::string& text) { return {text.begin(), text.end()}; }

void set_u32(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint32_t u32_at(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

struct Chunk {
  std::uint32_t type;
  Bytes data;
};

Bytes glb_of(const std::vector<Chunk>& chunks) {
  Bytes file;
  append<std::uint32_t>(file, 0x46546c67);
  append<std::uint32_t>(file, 2);
  append<std::uint32_t>(file, 0);
  for (const Chunk& chunk : chunks) {
    append(file, static_cast<std::uint32_t>(chunk.data.size()));
    append(file, chunk.type);
    file.insert(file.end(), chunk.data.begin(), chunk.data.end());
  }
  set_u32(file, 8, static_cast<std::uint32_t>(file.size()));
  return file;
}

/// The JSON and the BIN chunk of a valid file.
std::vector<Chunk> sound_chunks() {
  const Bytes glb = one_triangle().glb();
  const auto json_end = glb.begin() + 20 + u32_at(glb, 12);
  return {{kJsonChunk, Bytes(glb.begin() + 20, json_end)},
          {kBinChunk, Bytes(json_end + 8, glb.end())}};
}

void add_cuts(MalformedCases& cases) {
  const Bytes whole = one_triangle().glb();
  const std::size_t json_end = 20 + u32_at(whole, 12);
  for (const std::size_t size :
       {std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{7}, std::size_t{8},
        std::size_t{11}, std::size_t{12}, std::size_t{16}, std::size_t{19}, std::size_t{20},
        std::size_t{21}, json_end - 1, json_end, json_end + 1, json_end + 4, json_end + 8,
        json_end + 9, whole.size() - 4, whole.size() - 1}) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    cases.push_back(bytes_case("cut_at_" + std::to_string(size), cut, "scene.glb"));
    if (size < 12) continue;
    // The same bytes, but the header has the right length: only chunks are cut off.
    Bytes honest = cut;
    set_u32(honest, 8, static_cast<std::uint32_t>(size));
    cases.push_back(bytes_case("honest_cut_at_" + std::to_string(size), honest, "scene.glb"));
  }
}

void add_wrong_numbers(MalformedCases& cases) {
  const Bytes whole = one_triangle().glb();
  const std::size_t bin = 20 + u32_at(whole, 12);
  const auto changed = [&](const char* name, std::size_t at, std::uint32_t value,
                           const char* says) {
    Bytes bytes = whole;
    set_u32(bytes, at, value);
    cases.push_back(bytes_case(name, bytes, says));
  };
  const auto size = static_cast<std::uint32_t>(whole.size());
  const std::uint32_t json_length = u32_at(whole, 12), bin_length = u32_at(whole, bin);
  changed("version_0", 4, 0, "GLB version 0");
  changed("version_1", 4, 1, "GLB version 1");
  changed("version_3", 4, 3, "GLB version 3");
  changed("magic", 0, 0x46546c68, "is not glTF");
  changed("length_0", 8, 0, "GLB header says 0 bytes");
  changed("length_11", 8, 11, "GLB header says 11 bytes");
  changed("length_too_long", 8, size + 4, "GLB header says");
  changed("length_of_4_gigabytes", 8, 0xffffffffu, "GLB header says");
  changed("length_too_short", 8, size - 4, "reads past the file");
  changed("json_length_0", 12, 0, "scene.glb");
  changed("json_length_of_4_gigabytes", 12, 0xfffffffcu, "GLB chunk at byte 12 reads past");
  changed("json_length_past_the_file", 12, size, "GLB chunk at byte 12 reads past");
  changed("json_length_not_of_four", 12, json_length - 1, "not a multiple of 4");
  changed("json_length_too_short", 12, json_length - 4, "scene.glb");
  changed("json_length_too_long", 12, json_length + 4, "scene.glb");
  changed("json_type", 16, kOtherChunk, "does not begin with a JSON chunk");
  changed("bin_first", 16, kBinChunk, "does not begin with a JSON chunk");
  changed("bin_length_0", bin, 0, "scene.glb");
  changed("bin_length_of_4_gigabytes", bin, 0xfffffffcu, "reads past the file");
  changed("bin_length_not_of_four", bin, bin_length - 1, "not a multiple of 4");
  changed("bin_type_unknown", bin + 4, kOtherChunk, "buffer 0: has no uri");
  changed("bin_type_json", bin + 4, kJsonChunk, "second JSON chunk");
}

void add_wrong_chunks(MalformedCases& cases) {
  const std::vector<Chunk> sound = sound_chunks();
  const Chunk other{kOtherChunk, Bytes(8, 1)};
  const auto add = [&](const char* name, const std::vector<Chunk>& chunks, const char* says) {
    cases.push_back(bytes_case(name, glb_of(chunks), says));
  };
  add("no_chunks", {}, "GLB chunk header at byte 12 is cut off");
  add("only_bin", {sound[1]}, "does not begin with a JSON chunk");
  add("bin_then_json", {sound[1], sound[0]}, "does not begin with a JSON chunk");
  add("two_json", {sound[0], sound[0], sound[1]}, "second JSON chunk");
  add("json_last", {sound[0], sound[1], sound[0]}, "second JSON chunk");
  add("two_bin", {sound[0], sound[1], sound[1]}, "BIN chunk");
  add("bin_third", {sound[0], other, sound[1]}, "BIN chunk");
  add("only_json", {sound[0]}, "buffer 0: has no uri");
  add("short_bin", {sound[0], {kBinChunk, Bytes(32, 0)}}, "buffer 0: is too short");
  add("empty_bin", {sound[0], {kBinChunk, {}}}, "buffer 0: is too short");
  add("empty_json", {{kJsonChunk, {}}, sound[1]}, "is not glTF");
  add("binary_json", {{kJsonChunk, Bytes(64, 0xfe)}, sound[1]}, "is not glTF");
  Bytes cut_third = glb_of({sound[0], sound[1], other});
  cut_third.erase(cut_third.end() - 4, cut_third.end());  // g++ 12 warns of overflows in resize()
  set_u32(cut_third, 8, static_cast<std::uint32_t>(cut_third.size()));
  cases.push_back(bytes_case("third_chunk_cut", cut_third, "reads past the file"));
  Bytes followed = one_triangle().glb();
  followed.insert(followed.end(), {'j', 'u', 'n', 'k'});
  cases.push_back(bytes_case("junk_behind", followed, "goes on for 4 more"));
}

void add_other_files(MalformedCases& cases) {
  Bytes noise;
  std::uint32_t state = 1;
  for (int i = 0; i < 4096; ++i) {
    state = state * 1664525u + 1013904223u;
    noise.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  cases.push_back(bytes_case("empty", {}, "is empty"));
  cases.push_back(bytes_case("noise", noise, "is not glTF"));
  cases.push_back(bytes_case("zeros", Bytes(1000, 0), "is not glTF"));
  cases.push_back(bytes_case("png", png::with_alpha(2, 2, Bytes(4, 9)), "is not glTF"));
  cases.push_back(bytes_case("text", text_bytes("o cube\nv 0 0 0\nf 1 2 3\n"), "is not glTF"));
  cases.push_back(bytes_case("gzip", {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3}, "is not glTF"));
  cases.push_back(
      bytes_case("gltf_1", text_bytes(R"({"asset":{"version":"1.0"},"meshes":{}})"), "scene.glb"));
}

}  // namespace

void add_malformed_containers(MalformedCases& cases) {
  add_cuts(cases);
  add_wrong_numbers(cases);
  add_wrong_chunks(cases);
  add_other_files(cases);
}

}  // namespace dapple::test
