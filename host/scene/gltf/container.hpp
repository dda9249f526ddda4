// A scene file's two parts: the JSON text, and for GLB the binary chunk. In come the
// file's bytes, out go views of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace dapple::gltf {

struct Container {
  std::string_view json;
  std::optional<std::span<const std::uint8_t>> binary;  ///< GLB's BIN chunk
};

/// Splits .gltf or .glb bytes, told apart by their first four. Throws Error input when
/// GLB's lengths do not add up
/// or its chunks are not JSON, then BIN, then what nobody knows.
Container split_container(std::span<const std::uint8_t> bytes, const std::string& file);

}  // namespace dapple::gltf
