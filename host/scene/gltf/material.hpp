// Reads materials: opacity, its texture and texture coordinates, emission. In: a document and its
// placed nodes; out: Scene::materials and Scene::textures.
#pragma once

#include <vector>

#include "dapple/scene.hpp"
#include "scene/gltf/document/document.hpp"
#include "scene/gltf/pose/hierarchy.hpp"

namespace dapple::gltf {

/// How a material's alpha texture is looked up: the number of the TEXCOORD attribute, and the
/// affine map of KHR_texture_transform from its coordinates to those of the texture.
struct AlphaLookup {
  int texcoord = 0;
  V2f du{1, 0};  ///< change of the result along u
  V2f dv{0, 1};  ///< change of the result along v
  V2f offset{0, 0};
  bool has_texture = false;  ///< the material has a texture, whether it is read or not

  [[nodiscard]] V2f apply(V2f uv) const { return uv.x * du + uv.y * dv + offset; }
};

/// One AlphaLookup for each of Scene::materials, which are the glTF materials in their order, and
/// the index of the material "default", for primitives without a material.
struct MaterialSet {
  std::vector<AlphaLookup> lookups;
  std::uint32_t default_material = 0;

  [[nodiscard]] std::uint32_t index_of(int gltf_material) const {
    return gltf_material >= 0 ? static_cast<std::uint32_t>(gltf_material) : default_material;
  }
};

/// Appends to Scene::materials and Scene::textures. Reads images only for materials that a triangle
/// primitive of `placed` uses; `with_lines` says whether lines are shown too, `with_colors` whether
/// images are also read for their colours. Throws Error input
/// when an image whose alpha is used cannot be read.
MaterialSet read_materials(const Document& document, const std::vector<PlacedNode>& placed,
                           bool with_lines, bool with_colors, Scene& scene);

bool emits(const Material& material);

}  // namespace dapple::gltf
