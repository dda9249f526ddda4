// Converts a primitive of any mode and index type to triangles or segments. In: a document and a
// primitive; out: tuples of vertex indices.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

/// Whether a primitive has lines, as a list, a strip or a loop.
bool is_of_lines(const tinygltf::Primitive& primitive);

/// Whether any primitive of a mesh has lines.
bool has_lines(const tinygltf::Mesh& mesh);

/// Returns the number of a primitive's triangles or segments without reading geometry. Throws Error
/// input when the number of indices of a list is not a multiple of 3 or 2.
std::uint64_t element_count(const Document& document, const tinygltf::Primitive& primitive,
                            const std::string& who);

/// Returns three vertex indices per triangle or two per segment, all below the vertex count. In
/// strips, fans and loops, a triangle or segment that uses a vertex twice only connects others; it
/// is left out. Throws Error input, naming `who`, for an index that is not below the vertex count.
std::vector<std::uint32_t> element_corners(const Document& document,
                                           const tinygltf::Primitive& primitive,
                                           const std::string& who);

}  // namespace dapple::gltf
