// The vertices of one primitive, appended to a mesh: positions, and of texture coordinates, alphas
// and radii what its material and mode need.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/deformation.hpp"
#include "scene/gltf/document.hpp"
#include "scene/gltf/material.hpp"

namespace dapple::gltf {

/// The accessors of one primitive that dapple looks at.
struct Attributes {
  AccessorReader positions;
  std::optional<AccessorReader> uvs;
  std::optional<AccessorReader> colors;  ///< where they have an alpha
};

/// What of them is needed.
struct AttributeNeeds {
  bool uvs = false;
  bool colors = false;
};

/// -1 where the primitive has no such attribute.
int attribute(const tinygltf::Primitive& primitive, const std::string& name);

/// Throws Error input, beginning with `who`, for a type that an attribute cannot have. `uvs` stays
/// empty where the TEXCOORD of `lookup` is missing.
Attributes read_attributes(const Document& document, const tinygltf::Primitive& primitive,
                           const AttributeNeeds& needs, const AlphaLookup& lookup,
                           const std::string& who);

/// Renumbers `corners` 0, 1, 2... and returns the vertices that they used, in order, or
/// nothing where they may use all of them: primitives often share one long vertex
/// buffer, and copying all of it for each would square a file's size.
std::optional<std::vector<std::uint32_t>> compact(std::vector<std::uint32_t>& corners,
                                                  std::uint64_t vertices);

/// Appends the vertices `used`, or all, to `mesh`, where `deformer` has them; arrays that only some
/// primitives have are filled with their defaults, uv (0, 0) and alpha 1, for the others.
void append_vertices(Mesh& mesh, const Attributes& attributes, const VertexDeformer& deformer,
                     const AlphaLookup& lookup,
                     const std::optional<std::vector<std::uint32_t>>& used);

}  // namespace dapple::gltf
