// Reads the vertices of one primitive. In: its accessors and what its material needs; out:
// positions, normals, texture coordinates and alphas appended to a Mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/accessor.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/pose/deformation.hpp"

namespace dapple::gltf {

/// The accessors of one primitive that dapple reads.
struct Attributes {
  AccessorReader positions;
  std::optional<AccessorReader> normals;
  std::optional<AccessorReader> uvs;
  std::optional<AccessorReader> alphas;  ///< COLOR_0, if it has an alpha
  std::optional<AccessorReader> colors;  ///< COLOR_0
  bool needs_uvs = false;                ///< vertices without have (0, 0)
};

/// Which optional attributes the material needs.
struct AttributeNeeds {
  bool normals = false;
  bool uvs = false;
  bool alphas = false;
  bool colors = false;
};

/// Returns the accessor of an attribute, -1 when the primitive does not have it.
int attribute(const tinygltf::Primitive& primitive, const std::string& name);

/// TEXCOORD_`set`, if the primitive has it. Throws Error input, naming `who`, for a type that
/// texture coordinates cannot have.
std::optional<AccessorReader> read_uvs(const Document& document,
                                       const tinygltf::Primitive& primitive, std::uint32_t set,
                                       const std::string& who);

/// COLOR_0, if the primitive has it with `components` or more. Throws Error input, naming `who`,
/// for a type that colours cannot have.
std::optional<AccessorReader> read_colors(const Document& document,
                                          const tinygltf::Primitive& primitive,
                                          const std::string& who, std::uint64_t components);

/// Throws Error input, naming `who`, for a type that an attribute cannot have. `uvs` stays empty
/// when the primitive does not have the TEXCOORD of `lookup`.
Attributes read_attributes(const Document& document, const tinygltf::Primitive& primitive,
                           const AttributeNeeds& needs, const AlphaLookup& lookup,
                           const std::string& who);

/// Renumbers `corners` to 0, 1, 2... and returns the vertices that they used, in increasing order.
/// Primitives often share one long vertex buffer; copying all of it for each of them would take
/// memory of the square of the file's size, and bakes would give vertices values of primitives that
/// do not use them. Does nothing and returns none when the corners use all vertices.
std::optional<std::vector<std::uint32_t>> compact(std::vector<std::uint32_t>& corners,
                                                  std::uint64_t vertices);

/// Vertices whose numbers are not finite.
struct OddValues {
  std::uint64_t texcoords = 0, alphas = 0;
};

/// Appends the vertices `used`, or all, to `mesh`, at the positions and with the normals that
/// `deformer` returns. When only some primitives have normals, texture coordinates, alphas or
/// colours, the others get the defaults: normal (0, 0, 0), uv (0, 0), alpha 1 and white.
OddValues append_vertices(Mesh& mesh, const Attributes& attributes, const VertexDeformer& deformer,
                          const AlphaLookup& lookup,
                          const std::optional<std::vector<std::uint32_t>>& used);

}  // namespace dapple::gltf
