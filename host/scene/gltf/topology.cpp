// Converts lists, strips, fans and loops: see topology.hpp.
#include "scene/gltf/topology.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "scene/gltf/document/accessor.hpp"
#include "scene/message.hpp"

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

/// Returns a primitive's indices; 0, 1, 2... for one without indices.
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

/// Returns the positions in the indices of triangle `i` of a strip or fan, in the winding of glTF
/// 2.0, section 3.7.2.1.
std::array<std::size_t, 3> corner_positions(int mode, std::size_t i) {
  if (mode == TINYGLTF_MODE_TRIANGLE_FAN) return {i + 1, i + 2, 0};
  return {i, i + 1 + i % 2, i + 2 - i % 2};
}

void append_triangles(std::vector<std::uint32_t>& corners, int mode,
                      const std::vector<std::uint32_t>& indices, std::uint64_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto positions = corner_positions(mode, i);
    const std::uint32_t a = indices[positions[0]];
    const std::uint32_t b = indices[positions[1]];
    const std::uint32_t c = indices[positions[2]];
    if (a != b && b != c && c != a) corners.insert(corners.end(), {a, b, c});
  }
}

void append_segments(std::vector<std::uint32_t>& ends, const std::vector<std::uint32_t>& indices,
                     std::uint64_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t a = indices[i];
    const std::uint32_t b = indices[(i + 1) % indices.size()];
    if (a != b) ends.insert(ends.end(), {a, b});
  }
}

}  // namespace

bool is_of_lines(const tinygltf::Primitive& primitive) {
  return primitive.mode >= TINYGLTF_MODE_LINE && primitive.mode <= TINYGLTF_MODE_LINE_STRIP;
}

bool has_lines(const tinygltf::Mesh& mesh) {
  return std::any_of(mesh.primitives.begin(), mesh.primitives.end(), is_of_lines);
}

std::uint64_t element_count(const Document& document, const tinygltf::Primitive& primitive,
                            const std::string& who) {
  const std::uint64_t count = index_count(document, primitive);
  const auto whole = [&](std::uint64_t corners, const char* elements) {
    if (count % corners == 0) return count / corners;
    fail(document.file, "{}: {} indices do not make whole {}", who, grouped(count), elements);
  };
  switch (primitive.mode) {
    case TINYGLTF_MODE_LINE:
      return whole(2, "segments");
    case TINYGLTF_MODE_LINE_STRIP:
      return count < 2 ? 0 : count - 1;
    case TINYGLTF_MODE_LINE_LOOP:
      return count < 3 ? count / 2 : count;  // two points make one segment, not two
    case TINYGLTF_MODE_TRIANGLES:
      return whole(3, "triangles");
    default:
      return count < 3 ? 0 : count - 2;
  }
}

std::vector<std::uint32_t> element_corners(const Document& document,
                                           const tinygltf::Primitive& primitive,
                                           const std::string& who) {
  std::vector<std::uint32_t> indices = read_indices(document, primitive, who);
  const std::uint64_t count = element_count(document, primitive, who);
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == TINYGLTF_MODE_LINE)
    return indices;
  std::vector<std::uint32_t> corners;
  corners.reserve((is_of_lines(primitive) ? 2 : 3) * count);
  if (is_of_lines(primitive)) {
    append_segments(corners, indices, count);
  } else {
    append_triangles(corners, primitive.mode, indices, count);
  }
  return corners;
}

}  // namespace dapple::gltf
