// Decodes the primitives that KHR_draco_mesh_compression compresses. In: a parsed document with its
// buffers. Out: the same, whose primitives name accessors that have the decoded vertices and
// indices.
#pragma once

#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

/// Fills accessors without a bufferView; for others that primitives name, whose own data the
/// extension replaces, and for those of several streams, it adds accessors to document.model that
/// the file does not have. Indices become 32 bits wide, strips become triangles. Points, which are
/// not shown, stay compressed. Throws Error input for streams that are damaged or do not fit their
/// accessors.
void decode_compressed_primitives(Document& document);

}  // namespace dapple::gltf
