// Writes a glTF file again with more vertex attributes and values of instances. In: the file, and
// the new values. Out: a .glb or .gltf file in which all else is as it was, unknown extensions
// included.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dapple::gltf {

/// How the components of an attribute are stored.
enum class Storage : std::uint8_t {
  float32,
  normalized16,  ///< [0,1] as unsigned 16-bit integers
};

/// Values of all vertices of a primitive, `components` numbers each.
struct NewAttribute {
  std::uint32_t mesh = 0, primitive = 0;  ///< indices in the file
  std::string name;                       ///< such as "COLOR_0"; replaced if there is one
  std::uint32_t components = 1;           ///< 1 to 4
  Storage storage = Storage::float32;
  std::vector<float> values;
};

/// Values of the instances of a node: of one as `extras.ao`, of those of EXT_mesh_gpu_instancing as
/// the instance attribute _AO.
struct NodeValues {
  std::uint32_t node = 0;
  std::vector<float> values;
};

/// The file's COLOR_0 of a primitive, four components for each vertex, missing ones 1; empty if it
/// has none.
struct PrimitiveColors {
  std::uint32_t components = 0;  ///< 3 or 4; 0: none
  std::vector<float> values;     ///< RGBA
};

/// A glTF file that has been read, with what its writer needs. Throws Error input.
struct SourceFile {
  explicit SourceFile(const std::string& path, bool allow_outside = false);
  ~SourceFile();
  SourceFile(SourceFile&&) noexcept;

  /// Vertices of a primitive: the count of its POSITION.
  [[nodiscard]] std::size_t vertex_count(std::uint32_t mesh, std::uint32_t primitive) const;
  /// Equal for primitives that share their vertices and their attribute `name`.
  [[nodiscard]] std::uint64_t vertex_key(std::uint32_t mesh, std::uint32_t primitive,
                                         const std::string& name) const;
  [[nodiscard]] PrimitiveColors colors(std::uint32_t mesh, std::uint32_t primitive) const;

  struct Content;
  Content* content;
};

/// Writes `out` (.glb or .gltf by its name). Data of a .gltf go to a file beside it, and buffers
/// and images that the file names are copied there unless they are there already. Attributes with
/// the same vertex_key() are stored once. Throws Error usage, failed or input.
void write_with_values(const SourceFile& source, const std::string& out,
                       const std::vector<NewAttribute>& attributes,
                       const std::vector<NodeValues>& nodes);

/// The files that write_with_values() would write beside `out`.
std::vector<std::string> side_files_of(const SourceFile& source, const std::string& out);

}  // namespace dapple::gltf
