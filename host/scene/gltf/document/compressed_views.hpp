// Decodes bufferViews that EXT_meshopt_compression compresses, with meshoptimizer. In: the
// buffers that have bytes, and the bufferViews' JSON. Out: the buffers that have none, filled.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "scene/gltf/document/document.hpp"

namespace dapple::gltf {

/// Whether a buffer stands for what its bufferViews are decompressed to: it may have no bytes.
bool is_fallback_buffer(const nlohmann::json& buffer);

/// Buffers without bytes: the index, and how many they would have.
using FallbackBuffers = std::map<std::size_t, std::uint64_t>;

/// Fills `fallbacks` of document.buffers with what the checked `views` that are in them hold.
/// Throws Error input: a view is not compressed, or its data are damaged or of a later version.
void decode_compressed_views(Document& document, const nlohmann::json& views,
                             const FallbackBuffers& fallbacks);

}  // namespace dapple::gltf
