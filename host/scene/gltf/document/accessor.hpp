// Reads accessors: interleaved, sparse, normalized, of any component type. In: a validated
// document; out: numbers.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

/// glTF's componentType codes.
enum class Component : int {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126,
};

/// Returns the bytes of one component; 0 for a code that glTF does not have.
std::uint64_t component_bytes(int component_type);

/// Returns the number of components of a tinygltf type code: 1 for SCALAR to 16 for MAT4.
std::uint64_t component_count(int type);

/// Where the components of an element lie. Columns of matrices begin at multiples of four bytes
/// (glTF 2.0, section 3.6.2.4).
struct ElementLayout {
  std::uint64_t components = 0, rows = 0;  ///< rows: components of a column; vectors have one
  std::uint64_t component_bytes = 0, column_stride = 0;
  std::uint64_t stride = 0;  ///< of elements without a byteStride
  std::uint64_t bytes = 0;   ///< without padding after the last component

  [[nodiscard]] std::uint64_t offset(std::uint64_t component) const {
    return component / rows * column_stride + component % rows * component_bytes;
  }
};

ElementLayout element_layout(const tinygltf::Accessor& accessor);

/// "VEC3 of uint16", for messages.
std::string type_name(const tinygltf::Accessor& accessor);

/// Throws Error input, whose message begins with the file's name and `who`, unless the accessor
/// has one of these TINYGLTF types and one of these components.
void require_type(const Document& document, int accessor, const std::string& who,
                  std::initializer_list<int> types, std::initializer_list<Component> components);

/// Returns how many values a sparse accessor replaces; a reader visits each of them. Returns 0 for
/// other accessors and when `accessor` is -1.
std::uint64_t sparse_count(const Document& document, int accessor);

class AccessorReader {
 public:
  /// Throws Error input when sparse indices do not increase or are not below the count.
  AccessorReader(const Document& document, int index);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint64_t components() const { return layout_.components; }

  /// Returns a component as a float. Integers are mapped to [0,1] or [-1,1] when the accessor is
  /// normalized, and keep their value when it is not.
  [[nodiscard]] float number(std::uint64_t i, std::uint64_t component) const {
    return number_of(element(i), component, normalized_);
  }
  /// Like number(), but integers are always normalized.
  [[nodiscard]] float normalized(std::uint64_t i, std::uint64_t component) const {
    return number_of(element(i), component, true);
  }
  /// Returns a matrix for row vectors, p' = p M. glTF stores the columns of its transpose, which
  /// are the rows of M.
  [[nodiscard]] Imath::M44d matrix(std::uint64_t i) const;
  [[nodiscard]] Imath::V2f vec2(std::uint64_t i) const;
  [[nodiscard]] Imath::V3f vec3(std::uint64_t i) const;
  /// Returns a component as it is stored, as a number.
  [[nodiscard]] float stored(std::uint64_t i, std::uint64_t component) const {
    return number_of(element(i), component, false);
  }
  /// Returns the bytes of an element, element_bytes() of them; null for zeros.
  [[nodiscard]] const std::uint8_t* bytes(std::uint64_t i) const { return element(i); }
  [[nodiscard]] std::uint64_t element_bytes() const { return layout_.bytes; }
  /// Returns an unsigned integer, for accessors of indices.
  [[nodiscard]] std::uint32_t index(std::uint64_t i) const;

 private:
  /// Returns null for an element of zeros (an accessor without a bufferView).
  [[nodiscard]] const std::uint8_t* element(std::uint64_t i) const;
  [[nodiscard]] float number_of(const std::uint8_t* element, std::uint64_t component,
                                bool normalize) const;
  void read_sparse(const Document& document, const tinygltf::Accessor& accessor, int index);

  const std::uint8_t* base_ = nullptr;
  std::uint64_t stride_ = 0;
  std::uint64_t count_ = 0;
  ElementLayout layout_;
  Component type_ = Component::float32;
  bool normalized_ = false;
  std::vector<std::uint32_t> sparse_indices_;  ///< increasing
  const std::uint8_t* sparse_values_ = nullptr;
};

}  // namespace dapple::gltf
