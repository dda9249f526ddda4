// A glTF file that is kept in memory, so that baked values can be added to it. In: a path, then
// numbers of meshes, primitives and nodes of the file. Out: vertex counts, colours and texture
// coordinates of primitives; copies of meshes and instances in the kept file.
#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dapple/scene.hpp"

namespace dapple::gltf {

/// The file's COLOR_0 of a primitive, four components for each vertex, missing ones 1; empty if it
/// has none.
struct PrimitiveColors {
  std::uint32_t components = 0;  ///< 3 or 4; 0: none
  std::vector<float> values;     ///< RGBA
  bool are_floats = false;       ///< in the file
};

/// What identifies the vertices of a primitive: a copy of a mesh, POSITION and another attribute.
using VertexKey = std::array<std::uint32_t, 3>;

/// The kept file. Throws Error input.
struct SourceFile {
  explicit SourceFile(const std::string& path, bool allow_outside = false);
  ~SourceFile();
  SourceFile(SourceFile&&) noexcept;

  /// Vertices of a primitive: the count of its POSITION.
  [[nodiscard]] std::size_t vertex_count(std::uint32_t mesh, std::uint32_t primitive) const;
  /// Equal for primitives that share their vertices and their attribute `name`.
  [[nodiscard]] VertexKey vertex_key(std::uint32_t mesh, std::uint32_t primitive,
                                     const std::string& name) const;
  [[nodiscard]] PrimitiveColors colors(std::uint32_t mesh, std::uint32_t primitive) const;
  /// TEXCOORD_`set` of a primitive, of all its vertices; empty if it has none.
  [[nodiscard]] std::vector<Imath::V2f> uvs(std::uint32_t mesh, std::uint32_t primitive,
                                            std::uint32_t set) const;
  /// The same of the vertices that a mesh of the scene shows.
  [[nodiscard]] std::vector<Imath::V2f> uvs(const VertexSource& source, std::uint32_t set) const;
  /// The first texture of a primitive's materials, those of its variants too, that reads
  /// TEXCOORD_`set`: `baseColorTexture of material 2 ("bark")`. Empty if none does.
  [[nodiscard]] std::string texture_with_uvs(std::uint32_t mesh, std::uint32_t primitive,
                                             std::uint32_t set) const;
  /// Whether a primitive's material is KHR_materials_unlit: viewers use no occlusion texture of it.
  [[nodiscard]] bool is_unlit(std::uint32_t mesh, std::uint32_t primitive) const;
  /// The names of a primitive's attributes, sorted.
  [[nodiscard]] std::vector<std::string> attributes(std::uint32_t mesh,
                                                    std::uint32_t primitive) const;
  /// n of the TEXCOORD_n that its material's occlusion texture names; none if it has no such.
  [[nodiscard]] std::optional<std::uint32_t> occlusion_set(std::uint32_t mesh,
                                                           std::uint32_t primitive) const;
  /// The number of a primitive's TEXCOORD_n attributes.
  [[nodiscard]] std::uint32_t uv_sets(std::uint32_t mesh, std::uint32_t primitive) const;

  /// Gives a node a copy of its mesh, which shares all accessors. Returns the index of the copy.
  std::uint32_t copy_mesh(std::uint32_t node, std::uint32_t mesh);
  /// Whether a node has many instances, by EXT_mesh_gpu_instancing.
  [[nodiscard]] bool has_skin(std::uint32_t node) const;
  [[nodiscard]] bool has_gpu_instances(std::uint32_t node) const;
  [[nodiscard]] bool has_instance_features(std::uint32_t node) const;
  /// Replaces them by child nodes with the same mesh; the extension that numbers instances by their
  /// features goes. Returns the index of each one's node, in order; -1 for an instance whose place
  /// is not finite, which gets none. finish_splits() must follow.
  std::vector<int> split_gpu_instances(std::uint32_t node);
  /// Once, after all nodes are split: animations of their weights move the child nodes, and
  /// extensions that nothing uses any more are not listed. `parts`: what split_gpu_instances()
  /// returned, by node.
  void finish_splits(const std::map<int, std::vector<int>>& parts);

  struct Content;
  Content* content;
};

}  // namespace dapple::gltf
