// Reads geometry. In: a glTF mesh and how a node uses it; out: one dapple::Mesh of its triangles,
// one of its lines, and one for each of its materials that emit, because a mesh light is a separate
// mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/document/found.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/pose/deformation.hpp"
#include "scene/gltf/pose/mesh_use.hpp"

namespace dapple::gltf {

struct MeshPart {
  std::uint32_t mesh = 0;  ///< index into Scene::meshes
  int emitter = -1;        ///< index into Scene::materials when the part emits, else -1
};

/// Totals over all meshes, for limits and for one warning per feature.
struct MeshTotals {
  std::uint64_t elements = 0;  ///< triangles and segments
  std::uint64_t sparse_values = 0;
  std::uint64_t deformed = 0;          ///< numbers that are read to deform vertices
  std::uint64_t thin_lines = 0;        ///< primitives of lines without a radius
  std::uint64_t points = 0;            ///< primitives
  std::uint64_t textured_lines = 0;    ///< primitives of lines whose opacity has a texture
  std::uint64_t shining_lines = 0;     ///< primitives of lines that emit
  std::uint64_t without_position = 0;  ///< primitives
  Found without_primitives;            ///< meshes
  Found without_elements;              ///< primitives with fewer vertices than one triangle has
  Found without_view;                  ///< primitives whose POSITION has neither values nor view
  Found without_texcoord;              ///< primitives that lack the TEXCOORD of their texture
  Found odd_texcoords, odd_alphas;     ///< vertices whose number is NaN, or infinite
  Found fixed_attributes;              ///< primitives with morph targets of colours or TEXCOORD
};

/// Appends the parts of a glTF mesh to Scene::meshes, skinned by `joints` unless it is null. Parts
/// without primitives are left out. Throws Error input naming mesh and primitive.
std::vector<MeshPart> read_mesh(const Document& document, const MeshUse& use,
                                const std::vector<Imath::M44d>* joints,
                                const MaterialSet& materials, Scene& scene, MeshTotals& totals);

}  // namespace dapple::gltf
