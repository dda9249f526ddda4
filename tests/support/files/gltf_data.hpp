// Reads a glTF file without dapple's reader, so that tests of what dapple writes have a witness.
// In: the path of a .glb or .gltf file; out: its JSON and the numbers of its accessors.
#pragma once

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/files/draco_decoding.hpp"
#include "support/files/film_files.hpp"

namespace dapple::test {

using nlohmann::json;

/// A file whose side files, if any, are in its folder and have plain names.
class GltfData {
 public:
  explicit GltfData(const std::string& path) {
    const std::string bytes = film_test::bytes_of(path);
    std::string binary;
    if (bytes.substr(0, 4) == "glTF")
      split(bytes, binary);
    else
      doc = json::parse(bytes);
    for (const json& buffer : doc.value("buffers", json::array())) {
      const std::string file = buffer.value("uri", "");
      if (file.empty() && buffer.contains("extensions")) {
        buffers_.emplace_back(buffer.at("byteLength").get<std::size_t>(), '\0');
        continue;
      }
      const auto side = std::filesystem::path(path).parent_path() / file;
      buffers_.push_back(file.empty() ? binary : film_test::bytes_of(side.string()));
      EXPECT_GE(buffers_.back().size(), buffer.at("byteLength").get<std::size_t>()) << file;
    }
    for (const json& view : doc.value("bufferViews", json::array()))
      if (view.contains("extensions"))
        decompress(view, view["extensions"]["EXT_meshopt_compression"]);
    for (const json& mesh : doc.value("meshes", json::array()))
      for (const json& primitive : mesh.at("primitives"))
        if (primitive.value("extensions", json::object()).contains("KHR_draco_mesh_compression"))
          decode_primitive(primitive, primitive["extensions"]["KHR_draco_mesh_compression"]);
  }

  [[nodiscard]] const json& accessor(const json& index) const {
    return doc["accessors"].at(at(index));
  }

  /// As they are stored, normalized integers as integers; components of an element side by side.
  [[nodiscard]] std::vector<double> stored(const json& index) const {
    const json& a = accessor(index);
    const std::size_t n = components(a), count = a.at("count");
    std::vector<double> values(n * count, 0.0);
    if (const auto decoded = decoded_.find(at(index)); decoded != decoded_.end())
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = number(a["componentType"],
                           reinterpret_cast<const char*>(&decoded->second.at(i * size_of(a))));
    else if (a.contains("bufferView"))
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] =
            number(a["componentType"], element(a, i / n, n * size_of(a)) + i % n * size_of(a));
    if (a.contains("sparse")) substitute(a, values);
    return values;
  }

  /// The same as floats, normalized integers in [0,1] or [-1,1].
  [[nodiscard]] std::vector<float> floats(const json& index) const {
    static const std::map<int, double> kLargest = {
        {5120, 127}, {5121, 255}, {5122, 32767}, {5123, 65535}};
    const json& a = accessor(index);
    std::vector<float> values;
    for (const double value : stored(index))
      values.push_back(static_cast<float>(
          a.value("normalized", false) ? std::max(value / kLargest.at(a["componentType"]), -1.0)
                                       : value));
    return values;
  }

  static std::size_t components(const json& accessor) {
    static const std::map<std::string, std::size_t> kCounts = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
        {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
    return kCounts.at(accessor.at("type"));
  }
  /// Bytes of a component.
  static std::size_t size_of(const json& accessor) {
    static const std::map<int, std::size_t> kSizes = {{5120, 1}, {5121, 1}, {5122, 2},
                                                      {5123, 2}, {5125, 4}, {5126, 4}};
    return kSizes.at(accessor.at("componentType"));
  }

  json doc;

 private:
  static std::size_t at(const json& index) { return index.get<std::size_t>(); }

  /// The chunks of a GLB: their lengths are multiples of four and add up to the file's.
  void split(const std::string& bytes, std::string& binary) {
    std::uint32_t header[5] = {};
    std::memcpy(header, bytes.data(), sizeof header);
    EXPECT_EQ(header[2], bytes.size());
    EXPECT_EQ(header[3] % 4, 0u);
    doc = json::parse(bytes.substr(20, header[3]));
    const std::size_t end = 20 + header[3];
    if (end == bytes.size()) return;
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + end, 4);
    EXPECT_EQ(length % 4, 0u);
    EXPECT_EQ(end + 8 + length, bytes.size());
    binary = bytes.substr(end + 8);
  }

  /// Without filters.
  void decompress(const json& view, const json& compressed) {
    std::string& out = buffers_.at(at(view["buffer"]));
    const std::string& in = buffers_.at(at(compressed["buffer"]));
    const std::size_t from = compressed["byteOffset"], size = compressed["byteLength"];
    const std::size_t to = view["byteOffset"], count = compressed["count"],
                      stride = compressed["byteStride"];
    ASSERT_LE(from + size, in.size());
    ASSERT_LE(to + count * stride, out.size());
    const std::string mode = compressed["mode"];
    int (*decode)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t) =
        meshopt_decodeVertexBuffer;
    if (mode == "TRIANGLES") decode = meshopt_decodeIndexBuffer;
    if (mode == "INDICES") decode = meshopt_decodeIndexSequence;
    EXPECT_EQ(compressed.value("filter", "NONE"), "NONE");
    EXPECT_EQ(decode(&out[to], count, stride,
                     reinterpret_cast<const unsigned char*>(in.data()) + from, size),
              0);
  }

  /// The compressed data stand in for those of the accessors, which may have none.
  void decode_primitive(const json& primitive, const json& extension) {
    const json& view = doc["bufferViews"].at(at(extension.at("bufferView")));
    const std::string& buffer = buffers_.at(at(view["buffer"]));
    const std::size_t begin = view.value("byteOffset", std::size_t{0});
    const std::size_t size = view["byteLength"];
    ASSERT_LE(begin + size, buffer.size());
    const DracoDecoding mesh(buffer.data() + begin, size);
    ASSERT_FALSE(extension.at("attributes").empty());
    for (const auto& [name, id] : extension["attributes"].items()) {
      const json& index = primitive["attributes"].at(name);
      EXPECT_EQ(accessor(index).at("count"), mesh.vertex_count()) << name;
      decoded_[at(index)] = mesh.values(id, accessor(index)["componentType"]);
    }
    if (!primitive.contains("indices") || primitive.value("mode", 4) == 5) return;
    const json& a = accessor(primitive["indices"]);
    std::vector<std::uint8_t>& bytes = decoded_[at(primitive["indices"])];
    const std::vector<std::uint32_t> indices = mesh.indices();
    EXPECT_EQ(a.at("count"), indices.size());
    for (const std::uint32_t i : indices)
      for (std::size_t byte = 0; byte < size_of(a); ++byte)
        bytes.push_back(static_cast<std::uint8_t>(i >> 8 * byte));
  }

  [[nodiscard]] const char* in_view(const json& index, std::size_t offset, std::size_t size) const {
    const json& view = doc["bufferViews"].at(at(index));
    if (offset + size > view.at("byteLength").get<std::size_t>())
      throw std::out_of_range("an accessor reads past bufferView " + index.dump());
    const std::size_t begin = view.value("byteOffset", std::size_t{0}) + offset;
    const std::string& buffer = buffers_.at(at(view.at("buffer")));
    if (begin + size > buffer.size())
      throw std::out_of_range("bufferView " + index.dump() + " reads past its buffer");
    return buffer.data() + begin;
  }
  [[nodiscard]] const char* element(const json& a, std::size_t i, std::size_t size) const {
    const json& view = doc["bufferViews"].at(at(a.at("bufferView")));
    const std::size_t stride = view.value("byteStride", size);
    return in_view(a["bufferView"], a.value("byteOffset", std::size_t{0}) + i * stride, size);
  }
  void substitute(const json& a, std::vector<double>& values) const {
    const json &sparse = a["sparse"], &where = sparse["indices"], &what = sparse["values"];
    const std::size_t n = components(a), size = size_of(a), index_size = size_of(where);
    const std::size_t first = where.value("byteOffset", std::size_t{0}),
                      begin = what.value("byteOffset", std::size_t{0});
    for (std::size_t i = 0; i < sparse["count"]; ++i) {
      const double target = number(
          where["componentType"], in_view(where["bufferView"], first + i * index_size, index_size));
      for (std::size_t c = 0; c < n; ++c)
        values.at(static_cast<std::size_t>(target) * n + c) = number(
            a["componentType"], in_view(what["bufferView"], begin + (i * n + c) * size, size));
    }
  }

  template <class T>
  static double as(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }
  static double number(int type, const char* bytes) {
    switch (type) {
      case 5120:
        return as<std::int8_t>(bytes);
      case 5121:
        return as<std::uint8_t>(bytes);
      case 5122:
        return as<std::int16_t>(bytes);
      case 5123:
        return as<std::uint16_t>(bytes);
      case 5125:
        return as<std::uint32_t>(bytes);
      default:
        return as<float>(bytes);
    }
  }

  std::vector<std::string> buffers_;
  std::map<std::size_t, std::vector<std::uint8_t>> decoded_;  ///< by accessor
};

}  // namespace dapple::test
