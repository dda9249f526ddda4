// Small glTF files for tests. The builder appends bytes to one buffer and elements to a JSON
// document; the result is written as .gltf or .glb into a temporary folder that is removed with
// the test. Also here: an encoder of PNG images, and a scene's triangles in world space.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dapple/error.hpp"
#include "dapple/scene.hpp"

namespace dapple::test {

using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

inline constexpr int kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125,
                     kFloat = 5126;

/// A new folder below the system's temporary folder; the destructor removes it.
class TempFolder {
 public:
  TempFolder() {
    static int next = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("dapple_gltf_" + std::to_string(::getpid()) + "_" + std::to_string(next++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }

  template <typename Container>
  std::string write(const std::string& name, const Container& content) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()),
               static_cast<std::streamsize>(content.size()));
    return file.string();
  }

 private:
  std::filesystem::path path_;
};

template <typename T>
void append(Bytes& bytes, T value) {
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}

template <typename T>
Bytes pack(const std::vector<T>& values) {
  Bytes bytes;
  for (const T value : values) append(bytes, value);
  return bytes;
}

class GltfBuilder {
 public:
  GltfBuilder() { doc["asset"]["version"] = "2.0"; }

  /// Appends `element` to an array of the document; returns the element's index.
  int add(const char* array, json element) {
    doc[array].push_back(std::move(element));
    return static_cast<int>(doc[array].size()) - 1;
  }

  int add_view(const Bytes& bytes, int stride = 0) {
    while (bin.size() % 4 != 0) bin.push_back(0);
    json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    bin.insert(bin.end(), bytes.begin(), bytes.end());
    return add("bufferViews", view);
  }

  template <typename T>
  int add_accessor(const std::vector<T>& values, int component, const char* type,
                   bool normalized = false) {
    static const std::map<std::string, std::size_t> kSizes = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    json accessor = {{"bufferView", add_view(pack(values))},
                     {"componentType", component},
                     {"count", values.size() / kSizes.at(type)},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }

  int add_positions(const std::vector<float>& xyz) { return add_accessor(xyz, kFloat, "VEC3"); }

  /// Adds a mesh of one primitive and a node with it; returns the node's index.
  int add_mesh(json primitive) {
    const int mesh = add("meshes", {{"primitives", json::array({std::move(primitive)})}});
    return add("nodes", {{"mesh", mesh}});
  }

  /// Adds the triangle (0,0,0) (1,0,0) (0,1,0) and a node with it; returns the node's index.
  int add_triangle() {
    return add_mesh({{"attributes", {{"POSITION", add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
  }

  /// Adds an animation that moves `node` to `places` (x, y, z of each) at `times`, seconds.
  /// Returns the animation.
  json& add_movement(int node, const std::vector<float>& times, const std::vector<float>& places) {
    const int input = add_accessor(times, kFloat, "SCALAR"), output = add_positions(places);
    add("animations",
        {{"samplers", {{{"input", input}, {"output", output}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}});
    return doc["animations"].back();
  }

  [[nodiscard]] Bytes glb() const {
    json copy = doc;
    if (!bin.empty() && !copy.contains("buffers")) {
      copy["buffers"] = json::array({{{"byteLength", bin.size()}}});
    }
    std::string text = copy.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    Bytes padded = bin;
    padded.resize((bin.size() + 3) / 4 * 4, 0);
    Bytes file;
    append<std::uint32_t>(file, 0x46546c67);
    append<std::uint32_t>(file, 2);
    append(file, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + padded.size()));
    append(file, static_cast<std::uint32_t>(text.size()));
    append<std::uint32_t>(file, 0x4e4f534a);
    file.insert(file.end(), text.begin(), text.end());
    append(file, static_cast<std::uint32_t>(padded.size()));
    append<std::uint32_t>(file, 0x004e4942);
    file.insert(file.end(), padded.begin(), padded.end());
    return file;
  }

  /// Writes the document as GLB and reads it back.
  [[nodiscard]] Scene load(const SceneOptions& options = {}) const {
    const TempFolder folder;
    return load_gltf(folder.write("scene.glb", glb()), options);
  }

  json doc;
  Bytes bin;
};

using Triangle = std::array<V3f, 3>;

inline std::vector<Triangle> world_triangles(const Scene& scene) {
  std::vector<Triangle> triangles;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (std::size_t t = 0; t < mesh.primitive_count(); ++t) {
      Triangle triangle;
      for (std::size_t c = 0; c < 3; ++c) {
        triangle[c] = mesh.positions[mesh.indices[3 * t + c]] * instance.to_world;
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

/// Returns the message of the Error (kind input) that `load` throws; fails the test otherwise.
template <typename Load>
std::string input_error(Load load) {
  try {
    load();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line";
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return {};
}

inline std::string error_of(const GltfBuilder& builder) {
  return input_error([&] { return builder.load(); });
}

inline std::string error_of_file(const std::string& path) {
  return input_error([&] { return load_gltf(path); });
}

inline void expect_says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos)
      << "\"" << message << "\" lacks \"" << part << "\"";
}

inline GltfBuilder one_triangle() {
  GltfBuilder builder;
  builder.add_triangle();
  return builder;
}

namespace png {

inline std::uint32_t crc32(const Bytes& bytes) {
  std::uint32_t crc = ~0u;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

inline void append_big_endian(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>((value >> shift) & 0xffu));
  }
}

inline void append_chunk(Bytes& file, const char* type, const Bytes& data) {
  append_big_endian(file, static_cast<std::uint32_t>(data.size()));
  Bytes covered(type, type + 4);
  covered.insert(covered.end(), data.begin(), data.end());
  file.insert(file.end(), covered.begin(), covered.end());
  append_big_endian(file, crc32(covered));
}

/// A zlib stream with one stored (uncompressed) block; `raw` has at most 65,535 bytes.
inline Bytes stored_zlib(const Bytes& raw) {
  Bytes zlib = {0x78, 0x01, 0x01};
  append(zlib, static_cast<std::uint16_t>(raw.size()));
  append(zlib, static_cast<std::uint16_t>(~raw.size()));
  zlib.insert(zlib.end(), raw.begin(), raw.end());
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : raw) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  append_big_endian(zlib, (b << 16) | a);
  return zlib;
}

/// A PNG file. `samples` are row by row, big-endian where `bits` is 16. Colour types as in PNG:
/// 0 grey, 2 RGB, 4 grey and alpha, 6 RGBA.
inline Bytes encode(std::uint32_t width, std::uint32_t height, std::uint8_t bits,
                    std::uint8_t color_type, const Bytes& samples) {
  Bytes header;
  append_big_endian(header, width);
  append_big_endian(header, height);
  header.insert(header.end(), {bits, color_type, 0, 0, 0});
  Bytes raw;
  const std::size_t row = height == 0 ? 0 : samples.size() / height;
  for (std::size_t y = 0; y * row < samples.size(); ++y) {
    raw.push_back(0);
    const auto first = samples.begin() + static_cast<std::ptrdiff_t>(y * row);
    raw.insert(raw.end(), first, first + static_cast<std::ptrdiff_t>(row));
  }
  Bytes file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(file, "IHDR", header);
  append_chunk(file, "IDAT", stored_zlib(raw));
  append_chunk(file, "IEND", {});
  return file;
}

/// A PNG of black RGBA pixels with these alphas.
inline Bytes with_alpha(std::uint32_t width, std::uint32_t height, const Bytes& alphas) {
  Bytes samples;
  for (const std::uint8_t alpha : alphas) samples.insert(samples.end(), {0, 0, 0, alpha});
  return encode(width, height, 8, 6, samples);
}

}  // namespace png

}  // namespace dapple::test
