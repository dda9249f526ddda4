// Compresses the primitives of a file that a test has built, as KHR_draco_mesh_compression says,
// and undoes it. In: a GltfBuilder; out: another, with streams, or with what they decode to.
#pragma once

#include <draco/compression/expert_encode.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/files/draco_decoding.hpp"
#include "support/files/gltf_builder.hpp"

namespace dapple::test {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

struct DracoOptions {
  /// MESH_SEQUENTIAL_ENCODING, which primitives with morph targets have, keeps the order.
  int method = draco::MESH_EDGEBREAKER_ENCODING;
  int bits = 0;  ///< of quantized floats; 0: they stay as they are
  int speed = 5;
  bool with_fallback = false;  ///< plain accessors of the decoded values stay in the file
  std::set<std::string> left_plain = {};  ///< attributes that are not compressed
};

/// The elements of an accessor without padding.
inline Bytes elements_of(const GltfBuilder& builder, int index) {
  static const std::map<std::string, std::size_t> kCounts = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  static const std::map<int, std::size_t> kSizes = {{kInt8, 1},   {kUint8, 1},  {kInt16, 2},
                                                    {kUint16, 2}, {kUint32, 4}, {kFloat, 4}};
  const json& accessor = builder.doc["accessors"][static_cast<std::size_t>(index)];
  const json& view = builder.doc["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t size = kCounts.at(accessor["type"]) * kSizes.at(accessor["componentType"]);
  const std::size_t stride = view.value("byteStride", size), count = accessor["count"];
  const std::size_t begin =
      view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  Bytes bytes(size * count);
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(&bytes[i * size], &builder.bin.at(begin + i * stride), size);
  return bytes;
}

inline std::vector<std::uint32_t> indices_of(const GltfBuilder& builder, const json& primitive) {
  std::vector<std::uint32_t> indices;
  if (!primitive.contains("indices")) {
    const int position = primitive["attributes"]["POSITION"];
    const std::uint32_t count =
        builder.doc["accessors"][static_cast<std::size_t>(position)]["count"];
    for (std::uint32_t i = 0; i < count; ++i) indices.push_back(i);
    return indices;
  }
  const int index = primitive["indices"];
  const json& accessor = builder.doc["accessors"][static_cast<std::size_t>(index)];
  const Bytes bytes = elements_of(builder, index);
  const std::size_t count = accessor["count"], size = bytes.size() / count;
  indices.resize(count);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&indices[i], &bytes[i * size], size);
  return indices;
}

/// The id of an attribute in the stream: not its number there.
inline int draco_id(int number) { return 7 + 2 * number; }

inline int add_draco_attribute(draco::Mesh& mesh, const GltfBuilder& builder,
                               const std::string& name, int index) {
  using draco::GeometryAttribute;
  static const std::map<int, draco::DataType> kTypes = {
      {kInt8, draco::DT_INT8},     {kUint8, draco::DT_UINT8},   {kInt16, draco::DT_INT16},
      {kUint16, draco::DT_UINT16}, {kUint32, draco::DT_UINT32}, {kFloat, draco::DT_FLOAT32}};
  const json& accessor = builder.doc["accessors"][static_cast<std::size_t>(index)];
  const GeometryAttribute::Type type = name == "POSITION"             ? GeometryAttribute::POSITION
                                       : name == "NORMAL"             ? GeometryAttribute::NORMAL
                                       : name.starts_with("TEXCOORD") ? GeometryAttribute::TEX_COORD
                                       : name.starts_with("COLOR")    ? GeometryAttribute::COLOR
                                                                      : GeometryAttribute::GENERIC;
  const Bytes bytes = elements_of(builder, index);
  const std::size_t count = accessor["count"], size = bytes.size() / count;
  const draco::DataType data = kTypes.at(accessor["componentType"]);
  GeometryAttribute attribute;
  attribute.Init(
      type, nullptr,
      static_cast<std::uint8_t>(size / static_cast<std::size_t>(draco::DataTypeLength(data))), data,
      accessor.value("normalized", false), static_cast<std::int64_t>(size), 0);
  const int number = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(count));
  for (std::size_t i = 0; i < count; ++i)
    mesh.attribute(number)->SetAttributeValue(
        draco::AttributeValueIndex(static_cast<std::uint32_t>(i)), &bytes[i * size]);
  mesh.attribute(number)->set_unique_id(static_cast<std::uint32_t>(draco_id(number)));
  return number;
}

inline Bytes encoded_mesh(const draco::Mesh& mesh, const DracoOptions& options) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(options.method);
  encoder.SetSpeedOptions(options.speed, options.speed);
  for (int i = 0; options.bits > 0 && i < mesh.num_attributes(); ++i)
    if (mesh.attribute(i)->data_type() == draco::DT_FLOAT32)
      encoder.SetAttributeQuantization(i, options.bits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  EXPECT_TRUE(status.ok()) << status.error_msg_string();
  return {buffer.data(), buffer.data() + buffer.size()};
}

/// A view whose elements begin at multiples of four bytes.
inline int add_elements(GltfBuilder& builder, const Bytes& bytes, std::size_t count) {
  const std::size_t size = bytes.size() / count, stride = (size + 3) / 4 * 4;
  Bytes padded(stride * count);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&padded[i * stride], &bytes[i * size], size);
  return builder.add_view(padded, static_cast<int>(stride));
}

/// Puts what a primitive's stream holds in the places of its accessors.
inline void decode_draco(GltfBuilder& builder, json& primitive) {
  const json extension = primitive["extensions"][kDraco];
  const json& view = builder.doc["bufferViews"][extension["bufferView"].get<std::size_t>()];
  const DracoDecoding mesh(&builder.bin.at(view["byteOffset"].get<std::size_t>()),
                           view["byteLength"]);
  for (const auto& [name, id] : extension["attributes"].items()) {
    const auto index = primitive["attributes"][name].get<std::size_t>();
    json accessor = builder.doc["accessors"][index];
    const bool is_empty = !accessor.contains("bufferView");
    accessor["count"] = mesh.vertex_count();
    accessor["bufferView"] =
        add_elements(builder, mesh.values(id, accessor["componentType"]), mesh.vertex_count());
    if (is_empty)
      builder.doc["accessors"][index] = accessor;
    else
      primitive["attributes"][name] = builder.add("accessors", accessor);
  }
  const std::vector<std::uint32_t> indices = mesh.indices();
  const int component =
      primitive.contains("indices")
          ? builder.doc["accessors"][primitive["indices"].get<std::size_t>()]["componentType"]
                .get<int>()
          : kUint32;
  if (component == kUint32) {
    primitive["indices"] = builder.add_accessor(indices, kUint32, "SCALAR");
  } else if (component == kUint16) {
    primitive["indices"] = builder.add_accessor(
        std::vector<std::uint16_t>(indices.begin(), indices.end()), kUint16, "SCALAR");
  } else {
    primitive["indices"] =
        builder.add_accessor(Bytes(indices.begin(), indices.end()), kUint8, "SCALAR");
  }
  primitive["mode"] = 4;
}

/// Three corners a triangle, of lists and strips.
inline std::vector<std::uint32_t> triangles_of(const GltfBuilder& builder, const json& primitive) {
  const std::vector<std::uint32_t> indices = indices_of(builder, primitive);
  if (primitive.value("mode", 4) == 4) return indices;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i + 2 < indices.size(); ++i)
    corners.insert(corners.end(), {indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
  return corners;
}

inline void compress_primitive(GltfBuilder& builder, json& primitive, DracoOptions options) {
  const json& positions =
      builder.doc["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
  if (positions.contains("sparse")) return;  // stays plain
  if (primitive.contains("targets")) options.method = draco::MESH_SEQUENTIAL_ENCODING;
  draco::Mesh mesh;
  mesh.set_num_points(positions["count"].get<std::uint32_t>());
  json ids;
  for (const auto& [name, index] : primitive["attributes"].items())
    if (!options.left_plain.contains(name))
      ids[name] = draco_id(add_draco_attribute(mesh, builder, name, index));
  std::vector<std::uint32_t> corners = triangles_of(builder, primitive);
  // Draco decodes no more vertices than corners: what shows nothing stands for unused ones.
  while (corners.size() < mesh.num_points()) corners.push_back(0);
  corners.resize((corners.size() + 2) / 3 * 3, 0);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    mesh.AddFace({draco::PointIndex(corners[i]), draco::PointIndex(corners[i + 1]),
                  draco::PointIndex(corners[i + 2])});
  primitive["extensions"][kDraco] = {{"bufferView", builder.add_view(encoded_mesh(mesh, options))},
                                     {"attributes", ids}};
  json decoded = primitive;
  decode_draco(builder, decoded);  // the order and number of vertices may be others
  primitive["attributes"] = decoded["attributes"];
  if (primitive.value("mode", 4) == 4) primitive["indices"] = decoded["indices"];
  if (options.with_fallback) return;
  for (const auto& [name, id] : ids.items())
    builder.doc["accessors"][primitive["attributes"][name].get<std::size_t>()].erase("bufferView");
  if (primitive.contains("indices"))
    builder.doc["accessors"][primitive["indices"].get<std::size_t>()].erase("bufferView");
}

template <class Edit>
void for_each_primitive(GltfBuilder& builder, const Edit& edit) {
  for (std::size_t m = 0; m < builder.doc["meshes"].size(); ++m)
    for (std::size_t p = 0; p < builder.doc["meshes"][m]["primitives"].size(); ++p) {
      json primitive = builder.doc["meshes"][m]["primitives"][p];
      edit(primitive);
      builder.doc["meshes"][m]["primitives"][p] = primitive;
    }
}

/// All primitives, with a stream each.
inline GltfBuilder draco_compressed(GltfBuilder builder, const DracoOptions& options = {}) {
  for_each_primitive(builder,
                     [&](json& primitive) { compress_primitive(builder, primitive, options); });
  builder.doc["extensionsUsed"].push_back(kDraco);
  if (!options.with_fallback) builder.doc["extensionsRequired"].push_back(kDraco);
  return builder;
}

/// The same file without the extension.
inline GltfBuilder draco_decoded(GltfBuilder builder) {
  for_each_primitive(builder, [&](json& primitive) {
    if (!primitive.value("extensions", json::object()).contains(kDraco)) return;
    decode_draco(builder, primitive);
    primitive["extensions"].erase(kDraco);
  });
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!builder.doc.contains(list)) continue;
    json& names = builder.doc[list];
    names.erase(std::remove(names.begin(), names.end(), json(kDraco)), names.end());
  }
  return builder;
}

}  // namespace dapple::test
