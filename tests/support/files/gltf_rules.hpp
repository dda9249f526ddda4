// Rules of the glTF 2.0 specification for the data of a file: sections 3.6.2 (accessors: bounds,
// alignment), 3.7.2 (meshes) and 3.8 (textures). In: a path; out: failures of the test.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "support/files/gltf_data.hpp"

namespace dapple::test {

/// min and max are those of the data, to the bit; elements are aligned; floats are finite.
inline void expect_valid_accessor(const GltfData& file, std::size_t index) {
  const json& a = file.accessor(index);
  const std::vector<double> values = file.stored(index);
  const std::size_t n = GltfData::components(a), size = GltfData::size_of(a);
  ASSERT_GT(a.at("count").get<std::size_t>(), 0u);
  for (const double value : values) ASSERT_TRUE(std::isfinite(value));
  if (a.contains("bufferView")) {
    const json& view = file.doc["bufferViews"][a["bufferView"].get<std::size_t>()];
    const auto offset = a.value("byteOffset", std::size_t{0});
    EXPECT_EQ(offset % size, 0u);
    EXPECT_EQ((offset + view.value("byteOffset", std::size_t{0})) % size, 0u);
    if (view.contains("byteStride")) {
      EXPECT_EQ(view["byteStride"].get<std::size_t>() % 4, 0u);
      EXPECT_GE(view["byteStride"].get<std::size_t>(), n * size);
    }
  }
  for (const char* key : {"min", "max"}) {
    if (!a.contains(key)) continue;
    ASSERT_EQ(a[key].size(), n) << key;
    for (std::size_t c = 0; c < n; ++c) {
      double found = values[c];
      for (std::size_t i = c; i < values.size(); i += n)
        found = key == std::string("min") ? std::min(found, values[i]) : std::max(found, values[i]);
      EXPECT_EQ(a[key][c].get<double>(), found) << key << " of component " << c;
    }
  }
}

/// Attributes have one count, elements at multiples of four bytes, and sets without gaps.
inline void expect_valid_attributes(const GltfData& file, const json& attributes,
                                    std::size_t count) {
  for (const auto& [name, index] : attributes.items()) {
    const json& a = file.accessor(index);
    EXPECT_EQ(a.at("count").get<std::size_t>(), count) << name;
    if (!a.contains("bufferView")) continue;
    const json& view = file.doc["bufferViews"][a["bufferView"].get<std::size_t>()];
    EXPECT_EQ(a.value("byteOffset", 0) % 4, 0) << name;
    EXPECT_EQ(view.value("byteStride", GltfData::components(a) * GltfData::size_of(a)) % 4, 0u)
        << name;
    EXPECT_NE(view.value("target", 0), 34963) << name << " is in a view of indices";
    const std::size_t digit = name.find_last_of('_') + 1;
    if (name.starts_with("TEXCOORD_") && name[digit] > '0') {
      EXPECT_TRUE(attributes.contains("TEXCOORD_" + std::to_string(name[digit] - '1'))) << name;
    }
  }
}

inline void expect_unit_vectors(const GltfData& file, const json& index) {
  const std::vector<float> xyz = file.floats(index);
  for (std::size_t i = 0; i < xyz.size(); i += 3)
    ASSERT_NEAR(std::hypot(xyz[i], xyz[i + 1], xyz[i + 2]), 1, 5e-4) << i / 3;
}

inline void expect_valid_primitive(const GltfData& file, const json& primitive) {
  const json& attributes = primitive.at("attributes");
  const std::size_t count = file.accessor(attributes.at("POSITION")).at("count");
  expect_valid_attributes(file, attributes, count);
  for (const json& target : primitive.value("targets", json::array()))
    expect_valid_attributes(file, target, count);
  if (attributes.contains("NORMAL")) expect_unit_vectors(file, attributes["NORMAL"]);
  EXPECT_LT(primitive.value("material", -1),
            static_cast<int>(file.doc.value("materials", json::array()).size()));
  if (!primitive.contains("indices")) return;
  const json& a = file.accessor(primitive["indices"]);
  // The largest value of each type would restart a primitive.
  const double restart = std::pow(2.0, 8.0 * static_cast<double>(GltfData::size_of(a))) - 1;
  for (const double i : file.stored(primitive["indices"])) {
    ASSERT_LT(i, static_cast<double>(count));
    ASSERT_NE(i, restart);
  }
  if (!a.contains("bufferView")) return;  // compressed
  const json& view = file.doc["bufferViews"][a["bufferView"].get<std::size_t>()];
  EXPECT_FALSE(view.contains("byteStride"));
  EXPECT_NE(view.value("target", 0), 34962) << "indices are in a view of vertices";
}

/// Instance attributes have one count; textures and images that materials name are there.
inline void expect_valid_references(const GltfData& file) {
  for (const json& node : file.doc.value("nodes", json::array())) {
    const json extensions = node.value("extensions", json::object());
    if (!extensions.contains("EXT_mesh_gpu_instancing")) continue;
    std::set<std::size_t> counts;
    for (const json& index : extensions["EXT_mesh_gpu_instancing"].at("attributes"))
      counts.insert(file.accessor(index).at("count").get<std::size_t>());
    EXPECT_EQ(counts.size(), 1u);
  }
  for (const json& material : file.doc.value("materials", json::array())) {
    const json occlusion = material.value("occlusionTexture", json::object());
    EXPECT_LT(occlusion.value("index", -1),
              static_cast<int>(file.doc.value("textures", json::array()).size()));
  }
  for (const json& texture : file.doc.value("textures", json::array()))
    EXPECT_LT(texture.value("source", -1),
              static_cast<int>(file.doc.value("images", json::array()).size()));
}

/// Fails the test for each rule that the file breaks.
inline void expect_valid_gltf(const std::string& path) {
  SCOPED_TRACE(path);
  const GltfData file(path);
  for (std::size_t i = 0; i < file.doc.value("accessors", json::array()).size(); ++i) {
    SCOPED_TRACE("accessor " + std::to_string(i));
    expect_valid_accessor(file, i);
  }
  for (const json& mesh : file.doc.value("meshes", json::array()))
    for (const json& primitive : mesh.at("primitives")) {
      SCOPED_TRACE("primitive " + primitive.dump());
      expect_valid_primitive(file, primitive);
    }
  expect_valid_references(file);
}

}  // namespace dapple::test
