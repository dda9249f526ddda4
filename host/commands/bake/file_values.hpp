// Baked values by the vertices of the file. In: values of the meshes of a scene, of which several
// may show the same vertices (poses, placements). Out: for each primitive of the file a set of
// values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dapple/bake.hpp"
#include "scene/gltf/edit/source_file.hpp"

namespace dapple {

/// A primitive of the file, by its mesh and its number there.
using FilePrimitive = std::pair<std::uint32_t, std::uint32_t>;

/// Values of all vertices of a POSITION accessor. Vertices that no primitive uses have AO 1, and
/// bent normals and light of 0.
struct VertexValues {
  std::vector<float> ao;
  std::vector<V3f> bent;                ///< means of directions; empty without bent normals
  std::vector<std::vector<V3f>> light;  ///< by light
  std::vector<bool> taken;              ///< a primitive gave the value
};

/// Primitives that share vertices share a set of values if they agree where both use a vertex: so
/// do parts of a smooth surface. Others, such as two sides of a sheet and the faces of a cube, have
/// sets of their own.
struct FileValues {
  /// Indices of the primitives' sets.
  using SetIndex = std::pair<gltf::VertexKey, std::size_t>;

  std::map<gltf::VertexKey, std::vector<VertexValues>> sets;
  std::map<FilePrimitive, SetIndex> primitives;
};

/// `attribute`: what the values change, such as "COLOR_0", which primitives must share, too.
/// `meshes`: those without AO are left out. What several meshes show has the mean over their
/// placements, of which `placements` has the number by mesh.
FileValues file_values(const gltf::SourceFile& file, const Scene& scene,
                       const std::vector<BakedMesh>& meshes,
                       const std::vector<std::size_t>& placements, const std::string& attribute);

}  // namespace dapple
