// A primitive's triangles or segments as tuples of vertices, whatever its mode and index type.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.hpp"

namespace dapple::gltf {

/// Whether a primitive is of lines, as a list, a strip or a loop.
bool is_of_lines(const tinygltf::Primitive& primitive);

/// The triangles or segments that a primitive of such a mode has; needs no byte of geometry.
/// Throws Error input when a list's indices do not make whole ones.
std::uint64_t element_count(const Document& document, const tinygltf::Primitive& primitive,
                            const std::string& who);

/// Three vertex indices a triangle or two a segment, all below the vertex count; strips, fans and
/// loops lose what uses a vertex twice, which only stitches. Throws Error input, beginning with
/// `who`, for an index beyond the vertices.
std::vector<std::uint32_t> element_corners(const Document& document,
                                           const tinygltf::Primitive& primitive,
                                           const std::string& who);

}  // namespace dapple::gltf
