// Decodes a mesh of KHR_draco_mesh_compression, with Draco. In: the bytes of a stream, and how much
// memory it may take. Out: triangles, and attributes by their ids, as accessors store them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/document/accessor.hpp"
#include "scene/regular_file.hpp"

namespace draco {
class Mesh;
}  // namespace draco

namespace dapple::gltf {

/// Bytes of memory that streams may still take while they are decoded, as draco_mesh.cpp estimates
/// them before they are allocated.
struct DecodingMemory {
  std::uint64_t left = 0;
};

/// Whom messages name: a file, and "mesh 2 primitive 0" of it.
struct StreamUser {
  const std::string& file;
  const std::string& who;
};

class DracoMesh {
 public:
  /// Takes what the stream needs from `memory`. Throws Error input for a stream that is no mesh, is
  /// damaged, needs more than is left, or is of another version than the extension's, 2.2.
  DracoMesh(std::span<const std::uint8_t> stream, DecodingMemory& memory, const StreamUser& user);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  [[nodiscard]] std::uint64_t vertex_count() const;
  /// Three for each triangle, below vertex_count().
  [[nodiscard]] std::vector<std::uint32_t> indices() const;
  [[nodiscard]] std::uint64_t index_count() const;

  /// Returns the elements of attribute `id`, layout.stride bytes each, with components of `type`.
  /// Throws Error input where the stream has no such attribute, or values that do not fit.
  [[nodiscard]] Bytes attribute(std::uint32_t id, const ElementLayout& layout, Component type,
                                const StreamUser& user) const;

 private:
  std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace dapple::gltf
