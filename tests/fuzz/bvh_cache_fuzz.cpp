// Reads files of the BVH cache that dapple did not write: any bytes, or sealed files with a right
// checksum whose contents are arbitrary or edited. A file is refused with a message that names it,
// or rays can traverse its BVH.
#include <fuzzer/FuzzedDataProvider.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "bvh/storage/builder_version.hpp"
#include "bvh/storage/bvh_cache.hpp"
#include "files/sealed_file.hpp"

namespace {

using namespace dapple;

constexpr Checksum kKey = {1, 2};
constexpr std::size_t kMaxVisits = 100'000;

const std::string& folder() {
  static const std::string name = [] {
    const auto path =
        std::filesystem::temp_directory_path() / ("dapple_fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directory(path);
    return path.string();
  }();
  return name;
}

const std::string& file() {
  static const std::string name = folder() + "/" + hex_text(kKey) + ".bvh";
  return name;
}

void require(bool condition) {
  if (!condition) std::abort();
}

Scene scene_with_textures(std::size_t count) {
  Scene scene;
  scene.textures.resize(count);
  scene.materials.resize(2);
  scene.materials[1].alpha_texture = static_cast<int>(count) - 1;
  return scene;
}

/// A BVH over 60 triangles, opaque and textured.
CachedObject small_object() {
  Scene scene = scene_with_textures(1);
  scene.textures[0].width = scene.textures[0].height = 1;
  scene.textures[0].alpha = {128};
  scene.materials.resize(2);
  scene.materials[1].alpha_mode = AlphaMode::blend;
  scene.materials[1].alpha_texture = 0;
  Mesh mesh;
  for (std::uint32_t t = 0; t < 60; ++t) {
    const V3f p(static_cast<float>(t % 7), static_cast<float>(t % 11), static_cast<float>(t % 5));
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      mesh.positions.push_back(p + V3f(corner == 1, corner == 2, 0));
      mesh.uvs.emplace_back(0.0f, 0.5f);
      mesh.indices.push_back(3 * t + corner);
    }
    mesh.materials.push_back(t % 2);
  }
  BuiltObject built = build_object(scene, OpaqueTexels(scene), mesh);
  prefilter(built, TextureIntegrals(scene, built.object.textured));
  return {FinishedObject(std::move(built.object)), 1.0};
}

/// Visits all nodes and primitives that rays could reach, and checks every index.
void walk(const FinishedObject& object, std::uint32_t index, std::size_t& visits) {
  require(index < object.nodes.size());
  const BvhNode& node = object.nodes[index];
  if (++visits > kMaxVisits) return;  // files may share children between nodes
  for (uint slot = 0, inner = 0; slot < DAPPLE_BVH_WIDTH; ++slot) {
    if (node.inner_mask >> slot & 1) {
      require(node.child_base + inner > index);
      walk(object, node.child_base + inner++, visits);
    }
    for (std::uint32_t i = bvh_leaf_begin(&node, slot); i < bvh_leaf_end(node.leaf_end, slot);
         ++i) {
      if (node.prim_base & DAPPLE_SEGMENTS) {
        const std::size_t block = bvh_block_index(bvh_block(node.prim_base, i));
        require(block < object.segments.size());
        require(object.segments[block].opacity <= 1.0f);
        continue;
      }
      require(bvh_block(node.prim_base, i) < object.blocks.size());
      const float opacity = object.blocks[bvh_block(node.prim_base, i)].opacity[i % 8];
      require(opacity <= 1.0f);
      if (opacity >= 0.0f) continue;
      const auto textured = static_cast<std::size_t>(-opacity - 1.0f);
      require(textured < object.textured.size());
      require(unpack_textured(object.textured[textured]).material <
              scene_with_textures(1).materials.size());
    }
  }
}

void read() {
  std::string note;
  const auto cached = read_cached_object(folder(), kKey, scene_with_textures(1), note);
  if (!cached) return require(note.find(file() + ": ") != std::string::npos);
  std::size_t visits = 0;
  walk(cached->object, 0, visits);
}

void write_raw(FuzzedDataProvider& data) {
  const std::string bytes = data.ConsumeRemainingBytesAsString();
  std::ofstream(file(), std::ios::binary) << bytes;
}

using Contents = std::vector<std::vector<std::byte>>;

Contents sections_of_ours() {
  write_cached_object(folder(), kKey, small_object());
  const SealedFile ours = open_sealed_file(file(), {"BVH cache", 1});
  Contents contents;
  for (std::size_t i = 0; i < ours.section_count(); ++i) {
    contents.emplace_back(ours.section(i).begin(), ours.section(i).end());
  }
  return contents;
}

/// A file that dapple wrote, with some bytes and sizes of sections changed.
void write_edited(FuzzedDataProvider& data) {
  static const Contents ours = sections_of_ours();
  Contents contents = ours;
  while (data.remaining_bytes() > 0) {
    auto& bytes = contents[data.ConsumeIntegralInRange<std::size_t>(0, contents.size() - 1)];
    if (data.ConsumeIntegralInRange(0, 15) == 0) {
      bytes.resize(data.ConsumeIntegralInRange<std::size_t>(0, bytes.size() + 128));
    } else if (!bytes.empty()) {
      bytes[data.ConsumeIntegralInRange<std::size_t>(0, bytes.size() - 1)] =
          static_cast<std::byte>(data.ConsumeIntegral<std::uint8_t>());
    }
  }
  write_sealed_file(file(), {"BVH cache", 1},
                    std::vector<Section>(contents.begin(), contents.end()), Durable::no);
}

void write_any_sections(FuzzedDataProvider& data) {
  std::vector<std::string> contents;
  while (data.remaining_bytes() > 0 && contents.size() < kMaxSections)
    contents.push_back(data.ConsumeRandomLengthString());
  if (contents.size() > 1 && data.ConsumeBool()) contents[1] = std::string(builder_version());
  std::vector<Section> sections;
  for (const std::string& bytes : contents) sections.push_back(as_section(bytes));
  write_sealed_file(file(), {"BVH cache", 1}, sections, Durable::no);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  switch (data.ConsumeIntegralInRange(0, 5)) {
    case 0:
      write_raw(data);
      break;
    case 1:
      write_any_sections(data);
      break;
    default:
      write_edited(data);
  }
  read();
  return 0;
}
