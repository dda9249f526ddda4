// Reads accessors: see accessor.hpp.
#include "scene/gltf/document/accessor.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "scene/message.hpp"

namespace dapple::gltf {
namespace {

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// Normalizes as in glTF 2.0, section 3.11: c / 255 for uint8, max(c / 127, -1) for int8, and so
/// on.
template <typename T>
float load_number(const std::uint8_t* bytes, bool normalize) {
  const auto value = static_cast<float>(load<T>(bytes));
  if (!normalize) return value;
  return std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}

std::uint32_t load_index(const std::uint8_t* bytes, Component type) {
  if (type == Component::uint8) return *bytes;
  if (type == Component::uint16) return load<std::uint16_t>(bytes);
  return load<std::uint32_t>(bytes);
}

}  // namespace

std::uint64_t component_bytes(int component_type) {
  switch (static_cast<Component>(component_type)) {
    case Component::int8:
    case Component::uint8:
      return 1;
    case Component::int16:
    case Component::uint16:
      return 2;
    case Component::uint32:
    case Component::float32:
      return 4;
  }
  return 0;
}

std::uint64_t component_count(int type) {
  const int count = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
  return count > 0 ? static_cast<std::uint64_t>(count) : 0;
}

ElementLayout element_layout(const tinygltf::Accessor& accessor) {
  ElementLayout layout;
  layout.components = component_count(accessor.type);
  layout.component_bytes = component_bytes(accessor.componentType);
  const bool is_matrix = accessor.type == TINYGLTF_TYPE_MAT2 ||
                         accessor.type == TINYGLTF_TYPE_MAT3 || accessor.type == TINYGLTF_TYPE_MAT4;
  const std::uint64_t columns = accessor.type == TINYGLTF_TYPE_MAT2   ? 2
                                : accessor.type == TINYGLTF_TYPE_MAT3 ? 3
                                : is_matrix                           ? 4
                                                                      : 1;
  layout.rows = layout.components / columns;
  const std::uint64_t column = layout.rows * layout.component_bytes;
  layout.column_stride = is_matrix ? (column + 3) / 4 * 4 : column;
  layout.stride = columns * layout.column_stride;
  layout.bytes = layout.stride - layout.column_stride + column;
  return layout;
}

std::string type_name(const tinygltf::Accessor& accessor) {
  static constexpr const char* kComponents[] = {"int8",  "uint8",  "int16", "uint16",
                                                "int32", "uint32", "float"};
  static constexpr const char* kShapes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const std::uint64_t count = component_count(accessor.type);
  const bool is_vector = count >= 1 && count <= 4 && accessor.type != TINYGLTF_TYPE_MAT2;
  return fmt::format("{} of {}", is_vector ? kShapes[count - 1] : "MAT",
                     kComponents[accessor.componentType - 5120]);
}

void require_type(const Document& document, int accessor, const std::string& who,
                  std::initializer_list<int> types, std::initializer_list<Component> components) {
  const auto& given = document.model.accessors[static_cast<std::size_t>(accessor)];
  const auto component = static_cast<Component>(given.componentType);
  const bool fits = std::find(types.begin(), types.end(), given.type) != types.end() &&
                    std::find(components.begin(), components.end(), component) != components.end();
  if (fits) return;
  fail(document.file, "{} is accessor {}, which is {}: not a type that it can have", who, accessor,
       type_name(given));
}

std::uint64_t sparse_count(const Document& document, int accessor) {
  if (accessor < 0) return 0;
  const auto& sparse = document.model.accessors[static_cast<std::size_t>(accessor)].sparse;
  return sparse.isSparse ? static_cast<std::uint64_t>(sparse.count) : 0;
}

AccessorReader::AccessorReader(const Document& document, int index) {
  const auto& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  count_ = accessor.count;
  layout_ = element_layout(accessor);
  type_ = static_cast<Component>(accessor.componentType);
  normalized_ = accessor.normalized && type_ != Component::float32;
  stride_ = layout_.stride;
  if (accessor.bufferView >= 0) {
    const auto& view = document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (view.byteStride != 0) stride_ = view.byteStride;
    base_ = view_bytes(document, accessor.bufferView).data() + accessor.byteOffset;
  }
  if (accessor.sparse.isSparse) read_sparse(document, accessor, index);
}

void AccessorReader::read_sparse(const Document& document, const tinygltf::Accessor& accessor,
                                 int index) {
  const auto& sparse = accessor.sparse;
  const auto type = static_cast<Component>(sparse.indices.componentType);
  const std::uint64_t bytes = component_bytes(sparse.indices.componentType);
  const std::uint8_t* next =
      view_bytes(document, sparse.indices.bufferView).data() + sparse.indices.byteOffset;
  sparse_values_ = view_bytes(document, sparse.values.bufferView).data() + sparse.values.byteOffset;
  sparse_indices_.reserve(static_cast<std::size_t>(sparse.count));
  for (int i = 0; i < sparse.count; ++i, next += bytes) {
    const std::uint32_t at = load_index(next, type);
    const bool increases = sparse_indices_.empty() || at > sparse_indices_.back();
    if (at >= count_ || !increases) {
      fail(document.file,
           "accessor {}: sparse index {} is {}; they must increase and stay below {}", index, i,
           grouped(at), grouped(count_));
    }
    sparse_indices_.push_back(at);
  }
}

const std::uint8_t* AccessorReader::element(std::uint64_t i) const {
  if (!sparse_indices_.empty()) {
    const auto found = std::lower_bound(sparse_indices_.begin(), sparse_indices_.end(), i);
    if (found != sparse_indices_.end() && *found == i) {
      const auto at = static_cast<std::uint64_t>(found - sparse_indices_.begin());
      return sparse_values_ + at * layout_.stride;
    }
  }
  return base_ == nullptr ? nullptr : base_ + i * stride_;
}

float AccessorReader::number_of(const std::uint8_t* element, std::uint64_t component,
                                bool normalize) const {
  if (element == nullptr) return 0.0f;
  const std::uint8_t* bytes = element + layout_.offset(component);
  switch (type_) {
    case Component::int8:
      return load_number<std::int8_t>(bytes, normalize);
    case Component::uint8:
      return load_number<std::uint8_t>(bytes, normalize);
    case Component::int16:
      return load_number<std::int16_t>(bytes, normalize);
    case Component::uint16:
      return load_number<std::uint16_t>(bytes, normalize);
    case Component::uint32:
      return static_cast<float>(load<std::uint32_t>(bytes));
    case Component::float32:
      return load<float>(bytes);
  }
  return 0.0f;
}

Imath::M44d AccessorReader::matrix(std::uint64_t i) const {
  Imath::M44d matrix;
  std::uint64_t component = 0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column, ++component)
      matrix[row][column] = double{number(i, component)};
  }
  return matrix;
}

Imath::V2f AccessorReader::vec2(std::uint64_t i) const {
  const std::uint8_t* at = element(i);
  return {number_of(at, 0, normalized_), number_of(at, 1, normalized_)};
}

Imath::V3f AccessorReader::vec3(std::uint64_t i) const {
  const std::uint8_t* at = element(i);
  return {number_of(at, 0, normalized_), number_of(at, 1, normalized_),
          number_of(at, 2, normalized_)};
}

std::uint32_t AccessorReader::index(std::uint64_t i) const {
  const std::uint8_t* at = element(i);
  return at == nullptr ? 0 : load_index(at, type_);
}

}  // namespace dapple::gltf
