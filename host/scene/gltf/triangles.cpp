// Lists, strips and fans: see triangles.hpp.
#include "scene/gltf/triangles.hpp"

#include <array>
#include <limits>

#include "scene/gltf/accessor.hpp"
#include "scene/gltf/message.hpp"

namespace dapple::gltf {
namespace {

std::uint64_t vertex_count(const Document& document, const tinygltf::Primitive& primitive) {
  const int position = primitive.attributes.at("POSITION");
  return document.model.accessors[static_cast<std::size_t>(position)].count;
}

std::uint64_t index_count(const Document& document, const tinygltf::Primitive& primitive) {
  if (primitive.indices < 0) return vertex_count(document, primitive);
  return document.model.accessors[static_cast<std::size_t>(primitive.indices)].count;
}

/// 0, 1, 2... where the primitive has no indices.
std::vector<std::uint32_t> read_indices(const Document& document,
                                        const tinygltf::Primitive& primitive,
                                        const std::string& who) {
  const std::uint64_t vertices = vertex_count(document, primitive);
  std::vector<std::uint32_t> indices(index_count(document, primitive));
  if (primitive.indices < 0) {
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
    return indices;
  }
  require_type(document, primitive.indices, who + " indices", {TINYGLTF_TYPE_SCALAR},
               {Component::uint8, Component::uint16, Component::uint32});
  const AccessorReader reader(document, primitive.indices);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    indices[i] = reader.index(i);
    if (indices[i] >= vertices) {
      fail(document.file, "{}: index {} names vertex {}, but there are {} (accessor {})", who,
           grouped(i), grouped(indices[i]), grouped(vertices), primitive.indices);
    }
  }
  return indices;
}

/// glTF 2.0, section 3.7.2.1: the winding of every triangle i of a strip or fan.
std::array<std::size_t, 3> corner_places(int mode, std::size_t i) {
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {i + 1, i + 2, 0};
  return {i, i + 1 + i % 2, i + 2 - i % 2};
}

}  // namespace

std::uint64_t triangle_count(const Document& document, const tinygltf::Primitive& primitive,
                             const std::string& who) {
  const std::uint64_t count = index_count(document, primitive);
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES) return count < 3 ? 0 : count - 2;
  if (count % 3 != 0) {
    fail(document.file, "{}: {} indices do not make whole triangles", who, grouped(count));
  }
  return count / 3;
}

std::vector<std::uint32_t> triangle_corners(const Document& document,
                                            const tinygltf::Primitive& primitive,
                                            const std::string& who) {
  std::vector<std::uint32_t> indices = read_indices(document, primitive, who);
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) return indices;
  const std::uint64_t triangles = triangle_count(document, primitive, who);
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * triangles);
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto places = corner_places(primitive.mode, i);
    const std::uint32_t a = indices[places[0]];
    const std::uint32_t b = indices[places[1]];
    const std::uint32_t c = indices[places[2]];
    if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
  }
  return corners;
}

}  // namespace dapple::gltf
