// A primitive's triangles as vertex triples, whatever its mode and index type.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/document.hpp"

namespace dapple::gltf {

/// The triangles that a primitive of a triangle mode has; needs no byte of geometry.
/// Throws Error input when a list's indices do not make whole triangles.
std::uint64_t triangle_count(const Document& document, const tinygltf::Primitive& primitive,
                             const std::string& who);

/// Three vertex indices a triangle, all below the vertex count; strips and fans lose the
/// triangles that use a vertex twice, which only stitch. Throws Error input, beginning
/// with `who`, for an index beyond the vertices.
std::vector<std::uint32_t> triangle_corners(const Document& document,
                                            const tinygltf::Primitive& primitive,
                                            const std::string& who);

}  // namespace dapple::gltf
