// Splits a scene file into the JSON text and, for GLB, the binary chunk. In: the file's bytes; out:
// views of them.
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
  std::string_view others =
      {};  ///< GLB's chunks of other types, which come last, and their headers
};

/// Splits the bytes of a .gltf or .glb file; the first four bytes tell which one it is. Throws
/// Error input when GLB's lengths are inconsistent, when its first chunk is not JSON, or when a
/// JSON or BIN chunk comes later than glTF allows.
Container split_container(std::span<const std::uint8_t> bytes, const std::string& file);

}  // namespace dapple::gltf
