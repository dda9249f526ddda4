// Geometry: a glTF mesh becomes one dapple::Mesh, and one more for each material of it
// that emits, since a mesh light is a mesh of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/material.hpp"

namespace dapple::gltf {

struct MeshPart {
  std::uint32_t mesh = 0;  ///< index into Scene::meshes
  int emitter = -1;        ///< index into Scene::materials where the part emits
};

/// What reading adds up over all meshes: for limits, and for one warning a feature.
struct MeshTotals {
  std::uint64_t triangles = 0;
  std::uint64_t sparse_values = 0;
  std::uint64_t lines_and_points = 0;  ///< primitives of these modes
  std::uint64_t without_position = 0;  ///< primitives
  std::uint64_t without_texcoord = 0;  ///< primitives whose alpha texture lacks its TEXCOORD
  std::uint64_t morphed = 0;           ///< primitives with targets
};

/// Appends the parts of a glTF mesh to Scene::meshes; parts without triangles are left
/// out. Throws Error input naming mesh and primitive.
std::vector<MeshPart> read_mesh(const Document& document, int mesh, const MaterialSet& materials,
                                Scene& scene, MeshTotals& totals);

}  // namespace dapple::gltf
