// Decodes streams of KHR_draco_mesh_compression by Draco's whole decoder, which dapple does not
// use, so that tests have a witness. In: bytes; out: indices and the bytes of accessors.
#pragma once

#include <draco/compression/decode.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace dapple::test {

class DracoDecoding {
 public:
  DracoDecoding(const void* bytes, std::size_t size) {
    draco::DecoderBuffer buffer;
    buffer.Init(static_cast<const char*>(bytes), size);
    auto result = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    EXPECT_TRUE(result.ok()) << result.status().error_msg_string();
    if (result.ok()) mesh_ = std::move(result).value();
  }

  [[nodiscard]] std::size_t vertex_count() const { return mesh_ ? mesh_->num_points() : 0; }

  [[nodiscard]] std::vector<std::uint32_t> indices() const {
    std::vector<std::uint32_t> indices;
    for (draco::FaceIndex i(0); mesh_ && i < mesh_->num_faces(); ++i)
      for (std::size_t k = 0; k < 3; ++k) indices.push_back(mesh_->face(i)[k].value());
    return indices;
  }

  /// The components of all vertices, of glTF's componentType `component`, side by side.
  [[nodiscard]] std::vector<std::uint8_t> values(int id, int component) const {
    switch (component) {
      case 5120:
        return converted<std::int8_t>(id);
      case 5121:
        return converted<std::uint8_t>(id);
      case 5122:
        return converted<std::int16_t>(id);
      case 5123:
        return converted<std::uint16_t>(id);
      case 5125:
        return converted<std::uint32_t>(id);
      default:
        return converted<float>(id);
    }
  }

 private:
  template <class T>
  [[nodiscard]] std::vector<std::uint8_t> converted(int id) const {
    const draco::PointAttribute* attribute =
        mesh_ ? mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(id)) : nullptr;
    EXPECT_NE(attribute, nullptr) << id;
    if (attribute == nullptr) return {};
    const std::size_t n = attribute->num_components();
    std::vector<T> values(n * vertex_count());
    for (draco::PointIndex i(0); i < mesh_->num_points(); ++i)
      EXPECT_TRUE(attribute->ConvertValue<T>(attribute->mapped_index(i), &values[n * i.value()]));
    std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }

  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace dapple::test
